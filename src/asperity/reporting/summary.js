"use strict";
(() => {  // a summary is printed on one sheet: what is higher is made smaller
  const page = document.documentElement, button = document.getElementById("print-summary");
  const SHEET = (297 - 2 * 11) * 96 / 25.4 - 12;  // pixels between the margins of A4
  const fit = () => {
    if (!page.classList.contains("summary")) return;
    document.body.style.zoom = 1;
    const { height } = document.body.getBoundingClientRect();
    document.body.style.zoom = Math.min(1, SHEET / height);
  };
  const seen = (then) => requestAnimationFrame(() => requestAnimationFrame(then));
  if (button) {
    button.hidden = false;
    button.addEventListener("click", () => {
      page.classList.add("summary");
      seen(() => { fit(); seen(() => window.print()); });
    });
    window.addEventListener("afterprint", () => {
      page.classList.remove("summary");
      document.body.style.zoom = "";
    });
  } else {
    window.addEventListener("load", () => seen(fit));
    setTimeout(fit, 500);
  }
})();
