"""How pages of the documentation are made."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

EXTENSIONS = Path(__file__).parents[1] / "docs" / "extensions"
CELLS = """
import json, os, sys, tempfile
sys.path.insert(0, sys.argv[1])
from forked_cells import execute
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook

told = []
for timeout, *cells in json.loads(sys.argv[2]):
    made = [new_markdown_cell("# A page"), *map(new_code_cell, cells)]
    with tempfile.TemporaryDirectory() as folder:
        done = execute(new_notebook(cells=made), cwd=folder, timeout=timeout)
        told.append([[cell.outputs for cell in done.nb.cells[1:]], str(done.err), os.listdir(folder)])
print(json.dumps(told))
"""


@pytest.mark.skipif(sys.platform != "linux", reason="pages have a kernel each there")
def test_cells_of_a_page_run_in_a_process_of_their_own_and_leave_what_a_notebook_shows():
    shown = [
        "x = 2; print('said'); print(x)\nx + 1",
        "%%writefile kept.txt\nwords",
        "import matplotlib.pyplot as plt\nplt.plot([1, 2]);",
        "from asperity import material\nopen('kept.txt').read(), plt.get_backend()",
    ]
    stopped = ["y = 1", "x", "print(y)"]
    pages = [[60, *shown], [60, *stopped], [60, "import os; os._exit(3)"], [0.2, "while True: pass"]]
    command = [sys.executable, "-c", CELLS, str(EXTENSIONS), json.dumps(pages)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    (page, none, files), (until, failed, _), (_, died, _), (_, endless, _) = json.loads(done.stdout)
    said, written, figure, value = page
    assert [each["output_type"] for each in said] == ["stream", "execute_result"]
    assert said[0]["text"] == "said\n2\n"
    assert said[1]["data"] == {"text/plain": "3"}
    assert written[0]["text"] == "Writing kept.txt\n"
    assert [each["output_type"] for each in figure] == ["display_data"]  # the semicolon hides the lines
    assert figure[0]["data"]["image/png"].startswith("iVBOR")
    assert value[0]["data"]["text/plain"] == "('words\\n', 'inline')"
    assert value[0]["execution_count"] == 4
    assert files == ["kept.txt"]
    assert none == "None"
    assert [[each["output_type"] for each in cell] for cell in until] == [[], ["error"], []]
    assert failed.startswith("x\n")
    assert "name 'x' is not defined" in failed  # it is of another page
    assert died == "The process died."
    assert endless == "It had not ended after 0.2 s."
