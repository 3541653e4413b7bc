for (const table of document.querySelectorAll(".heat-map")) {
  const readout = table.closest("figure").querySelector(".readout");
  const rows = [...table.tBodies[0].rows].map((row) => [...row.querySelectorAll("td")]);
  const labels = [...table.tHead.querySelectorAll("th")].map((label) => label.textContent);
  const placeOf = (cell) => [cell.parentElement.sectionRowIndex, cell.cellIndex - 1];

  const read = (cell) => {
    const [row, column] = placeOf(cell);
    const unit = table.dataset.unit && cell.textContent !== "–" ? ` ${table.dataset.unit}` : "";
    readout.textContent = `${labels[row]} × ${labels[column]}: ${cell.textContent}${unit}`;
  };

  // One stop of the tab key a matrix; arrows go on from there.
  table.setAttribute("role", "grid");
  rows[0][0].tabIndex = 0;
  table.addEventListener("pointerover", (event) => {
    const cell = event.target.closest("tbody td");
    if (cell) read(cell);
  });
  table.addEventListener("pointerleave", () => {
    readout.textContent = "";
  });
  table.addEventListener("focusin", (event) => read(event.target));
  table.addEventListener("focusout", () => {
    readout.textContent = "";
  });
  table.addEventListener("keydown", (event) => {
    const move = { ArrowUp: [-1, 0], ArrowDown: [1, 0], ArrowLeft: [0, -1], ArrowRight: [0, 1] }[event.key];
    if (!move) return;
    event.preventDefault();
    const [row, column] = placeOf(event.target);
    const next = rows[row + move[0]]?.[column + move[1]];
    if (!next) return;
    event.target.tabIndex = -1;
    next.tabIndex = 0;
    next.focus();
  });
}
