"use strict";
(() => {
  const page = document.documentElement, button = document.getElementById("print-summary");
  button.hidden = false;
  button.addEventListener("click", () => {
    page.classList.add("summary");
    requestAnimationFrame(() => requestAnimationFrame(() => window.print()));
  });
  window.addEventListener("afterprint", () => page.classList.remove("summary"));
})();
