#!/bin/sh
# Make a virtual environment of its own for the peers of scan_step.py: benchmarks/peers.sh FOLDER
set -eu
if [ $# -ne 1 ]; then
    echo "usage: benchmarks/peers.sh FOLDER   (then: scan_step.py --peers-python FOLDER/bin/python)" >&2
    exit 2
fi
python3 -m venv "$1"
"$1/bin/python" -m pip install --quiet "tamaas==2.9.0" "ContactMechanics==1.8.3" "slippy==0.2.0" "pyfftw>=0.15"
# aspher is compiled; where its Eigen (3.4) is not found, name a copy: CMAKE_ARGS=-DFETCHCONTENT_SOURCE_DIR_EIGEN3_SRC=...
"$1/bin/python" -m pip install --quiet "aspher==0.1.3.post1" || echo "without aspher" >&2
echo "peers installed: $1/bin/python"
