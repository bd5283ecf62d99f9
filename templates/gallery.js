(function () {
  "use strict";
  // Only sorts and filters the table of objects; the page says all it has to say without it.
  var table = document.querySelector("table.list");
  var tools = document.getElementById("tools");
  if (!table || !tools) { return; }
  var body = table.tBodies[0];
  var rows = Array.prototype.slice.call(body.rows);
  rows.forEach(function (row, place) { row.dataset.p = place; });
  var find = tools.querySelector("input");
  var verdict = tools.querySelector("select");
  var shown = tools.querySelector("output");
  function filter() {
    var wanted = find.value.toLocaleLowerCase();
    var count = 0;
    rows.forEach(function (row) {
      var fits = (verdict.value === "" || row.dataset.s === verdict.value) ? row.textContent.toLocaleLowerCase().indexOf(wanted) !== -1 : false;
      row.hidden = !fits;
      count += fits ? 1 : 0;
    });
    shown.textContent = shown.dataset.words.replace("0", String(count).replace(/\B(?=(\d{3})+$)/g, shown.dataset.comma));
  }
  function key(row, column) {
    if (column === 0) { return row.cells[0].textContent; }
    if (column === 2) { return Number(row.dataset.u || -1); }
    if (column === 4) { return Number(row.dataset.p); }
    return row.cells.length === 5 ? row.cells[column].textContent.trim() : "";
  }
  Array.prototype.forEach.call(table.tHead.rows[0].cells, function (head, column) {
    var button = document.createElement("button");
    button.type = "button";
    button.textContent = head.textContent;
    head.textContent = "";
    head.appendChild(button);
    button.addEventListener("click", function () {
      var down = column === 2 ? head.getAttribute("aria-sort") !== "descending" : head.getAttribute("aria-sort") === "ascending";
      Array.prototype.forEach.call(table.tHead.rows[0].cells, function (other) { other.removeAttribute("aria-sort"); });
      head.setAttribute("aria-sort", down ? "descending" : "ascending");
      rows.sort(function (a, b) {
        var x = key(a, column), y = key(b, column);
        var order = typeof x === "number" ? x - y : x.localeCompare(y, undefined, { numeric: true });
        return (down ? -order : order) || a.dataset.p - b.dataset.p;
      }).forEach(function (row) { body.appendChild(row); });
    });
  });
  find.addEventListener("input", filter);
  verdict.addEventListener("change", filter);
  filter();
  tools.hidden = false;
}());
