"use strict";
const number = text => {
  const found = text.replace("−", "-").match(/[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?/i);
  return found && /^[\s≤≥<+\-\d.]/.test(text) ? parseFloat(found[0]) : NaN;
};
function compare(first, second, sign) {
  const a = number(first), b = number(second);
  if (!isNaN(a) && !isNaN(b)) return sign * (a - b);
  if (isNaN(a) !== isNaN(b)) return isNaN(a) ? 1 : -1;
  return sign * first.localeCompare(second);
}
function sort(head) {
  const column = head.cellIndex, body = head.closest("table").tBodies[0];
  const down = head.getAttribute("aria-sort") === "ascending";
  for (const other of head.parentElement.cells) other.removeAttribute("aria-sort");
  head.setAttribute("aria-sort", down ? "descending" : "ascending");
  const rows = [...body.rows].map(row => [row.cells[column].textContent.trim(), row]);
  rows.sort((a, b) => compare(a[0], b[0], down ? -1 : 1));
  body.append(...rows.map(pair => pair[1]));
}
for (const head of document.querySelectorAll("table.sortable th")) {
  head.tabIndex = 0;
  head.title = "Sort by this column";
  head.addEventListener("click", () => sort(head));
  head.addEventListener("keydown", event => {
    if (event.key === "Enter" || event.key === " ") { event.preventDefault(); sort(head); }
  });
}
function reveal(name) {
  const target = name && document.getElementById(decodeURIComponent(name.slice(1)));
  if (!target) return;
  for (let part = target; part; part = part.parentElement) if (part.tagName === "DETAILS") part.open = true;
  target.scrollIntoView();
}
const contents = document.querySelector(".contents > details");
const narrow = matchMedia("(max-width: 62rem)");
if (contents && narrow.matches) contents.open = false;
document.addEventListener("click", event => {
  const link = event.target.closest('a[href^="#"]'), button = event.target.closest("button[data-folds]");
  if (link) {
    if (contents && narrow.matches) contents.open = false;
    setTimeout(() => reveal(link.getAttribute("href")));
  }
  if (button) {
    for (const fold of document.querySelectorAll(".page details")) fold.open = button.dataset.folds === "open";
  }
});
reveal(location.hash);
