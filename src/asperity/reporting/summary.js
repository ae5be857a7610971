"use strict";
(() => {  // a summary is printed on one sheet: what is higher is made smaller
  const page = document.documentElement, button = document.getElementById("print-summary");
  const SHEET = (297 - 2 * 11) * 96 / 25.4 - 12;  // pixels between the margins of A4
  const fit = () => {
    if (!page.classList.contains("summary")) return;
    const zoom = Number(document.body.style.zoom) || 1, { height } = document.body.getBoundingClientRect();
    document.body.style.zoom = Math.min(1, zoom * SHEET / height);
  };
  // figures are lower on paper, and its letters are others: what is measured is what is printed
  window.addEventListener("beforeprint", fit);
  matchMedia("print").addEventListener("change", ({ matches }) => { if (matches) fit(); });
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
