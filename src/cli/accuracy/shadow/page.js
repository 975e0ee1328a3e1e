"use strict";
// Tables sort by the column whose head is pressed; numbers by value, which stands in data-value.
for (const table of document.querySelectorAll("table")) {
  const body = table.tBodies[0];
  for (const [column, head] of [...table.tHead.rows[0].cells].entries()) {
    const button = document.createElement("button");
    button.append(...head.childNodes);
    head.append(button);
    let rising = false;
    button.addEventListener("click", () => {
      rising = !rising;
      const key = (row) => row.cells[column].dataset.value ?? row.cells[column].textContent;
      const order = (a, b) => {
        const [x, y] = [key(a), key(b)];
        const numbers = x !== "" && y !== "" && !isNaN(x) && !isNaN(y);
        return (rising ? 1 : -1) * (numbers ? x - y : x.localeCompare(y));
      };
      body.append(...[...body.rows].sort(order));
    });
  }
}
// The truth lies under each technique's picture; a slider moves the edge between the two.
for (const pair of document.querySelectorAll(".compare")) {
  const truth = document.querySelector(pair.dataset.truth);
  const shown = pair.querySelector("img");
  const over = document.createElement("div");
  over.className = "over";
  const under = truth.cloneNode();
  under.removeAttribute("id");
  under.alt = "the truth";
  pair.insertBefore(under, shown);
  over.append(shown);
  const rule = document.createElement("div");
  rule.className = "rule";
  const slider = document.createElement("input");
  slider.type = "range";
  slider.value = 50;
  slider.setAttribute("aria-label", "left of the edge the truth, right of it the technique");
  slider.addEventListener("input", () => pair.style.setProperty("--at", slider.value + "%"));
  pair.append(over, rule, slider);
  pair.nextElementSibling.textContent += " Left of the edge: the truth. Drag to move the edge.";
}
// A press enlarges a picture; Escape closes it.
const dialog = document.createElement("dialog");
document.body.append(dialog);
dialog.addEventListener("click", () => dialog.close());
for (const image of document.querySelectorAll("figure.large img")) {
  image.style.cursor = "zoom-in";
  image.addEventListener("click", () => {
    const copy = image.cloneNode();
    copy.removeAttribute("id");
    dialog.replaceChildren(copy);
    dialog.showModal();
  });
}
// Arrows step through the techniques.
const sections = [...document.querySelectorAll("section.technique")];
document.addEventListener("keydown", (event) => {
  const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
  if (!step || event.target.matches("input")) return;
  const next = sections.findIndex((section) => section.getBoundingClientRect().top > 8 + (step > 0 ? 1 : -8));
  const at = step > 0 ? next : (next < 0 ? sections.length : next) - 1;
  sections[at]?.scrollIntoView();
});
