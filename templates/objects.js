(function () {
  "use strict";
  // Only narrows the list to what is looked for, and keeps that in the address; the page is a plain list without it.
  var tools = document.getElementById("tools");
  var table = document.querySelector("table.objects");
  if (!tools || !table) { return; }
  var rows = Array.prototype.slice.call(table.tBodies[0].rows);
  var texts = rows.map(function (row) { return row.textContent.toLocaleLowerCase(); });
  var find = tools.querySelector("input");
  var state = tools.querySelectorAll("select")[0], gallery = tools.querySelectorAll("select")[1];
  var shown = tools.querySelector("output");
  var turns = Array.prototype.slice.call(document.querySelectorAll(".turn [data-first]"));
  var fields = { find: find, state: state, gallery: gallery };
  var compare = new Intl.Collator(undefined, { numeric: true }).compare;
  function place(row) { return row.cells[2].textContent; }
  Object.keys(rows.reduce(function (all, row) { all["=" + place(row)] = true; return all; }, {})).sort(compare).forEach(function (one) {
    var option = document.createElement("option");
    option.value = option.textContent = one.slice(1);
    gallery.appendChild(option);
  });
  function address() {
    return Object.keys(fields).filter(function (name) { return fields[name].value !== ""; }).map(function (name) {
      return name + "=" + encodeURIComponent(fields[name].value);
    }).join(";");
  }
  function elsewhere(number) {
    var there = turns.filter(function (one) {
      return one.tagName === "A" ? !(Math.max(compare(one.dataset.first, number), compare(number, one.dataset.last)) > 0) : false;
    })[0];
    if (!there) { return; }
    var link = document.createElement("a");
    link.href = there.href;
    link.textContent = shown.dataset.page.replace("0", there.textContent);
    shown.appendChild(document.createTextNode(". "));
    shown.appendChild(link);
  }
  function filter() {
    var words = find.value.toLocaleLowerCase().split(/\s+/).filter(Boolean);
    var count = 0;
    rows.forEach(function (row, at) {
      var fits = [state.value === "" || row.dataset.s === state.value, gallery.value === "" || place(row) === gallery.value]
        .concat(words.map(function (word) { return texts[at].indexOf(word) !== -1; })).every(Boolean);
      row.hidden = !fits;
      count += fits ? 1 : 0;
    });
    shown.textContent = shown.dataset.words.replace("0", String(count).replace(/\B(?=(\d{3})+$)/g, shown.dataset.comma));
    turns.forEach(function (one) { if (one.tagName === "A") { one.href = one.getAttribute("href").split("#")[0] + (address() ? "#" + address() : ""); } });
    if (count === 0) { elsewhere(find.value.trim()); }
  }
  function remember() {
    filter();
    history.replaceState(null, "", "#" + address());
  }
  function recall() {
    location.hash.slice(1).split(";").forEach(function (pair) {
      var at = pair.indexOf("=");
      var field = Object.prototype.hasOwnProperty.call(fields, pair.slice(0, at)) ? fields[pair.slice(0, at)] : null;
      if (!field) { return; }
      try { field.value = decodeURIComponent(pair.slice(at + 1)); } catch (error) { field.value = ""; }
      // A gallery of another page of the list is none of this one.
      if (field.selectedIndex === -1) { field.value = ""; }
    });
    filter();
  }
  tools.addEventListener("input", remember);
  window.addEventListener("hashchange", recall);
  recall();
  tools.hidden = false;
}());
