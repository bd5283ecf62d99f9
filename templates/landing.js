(function () {
  "use strict";
  // Says how long ago things were, and makes the page red where the last good night is too old; the times stand there
  // without it.  Words for ages are the browser's own, in the language of the page.
  var words;
  try {
    words = new Intl.RelativeTimeFormat(document.documentElement.lang, { numeric: "auto" });
  } catch (unknown) {
    words = new Intl.RelativeTimeFormat(undefined, { numeric: "auto" });
  }
  function said(minutes) {
    if (minutes < 90) { return words.format(-Math.round(minutes), "minute"); }
    if (minutes < 48 * 60) { return words.format(-Math.round(minutes / 60), "hour"); }
    return words.format(-Math.round(minutes / 1440), "day");
  }
  function look() {
    var now = Date.now(), late = document.getElementById("late");
    Array.prototype.forEach.call(document.querySelectorAll("time[data-age]"), function (time) {
      var minutes = (now - Date.parse(time.getAttribute("datetime"))) / 60000;
      var age = time.nextElementSibling;
      // A clock that is behind tells no age.
      if (minutes >= 0 && age) { age.textContent = " (" + said(minutes) + ")"; }
    });
    var running = document.getElementById("running");
    var cut = !!running && now - Date.parse(running.getAttribute("data-began")) > Number(running.getAttribute("data-hours")) * 3600000;
    if (running) { running.className = cut ? "alarm" : "note"; }
    var good = document.querySelector("time[data-good]"), ahead = document.getElementById("ahead");
    if (late && good) {
      var hours = (now - Date.parse(good.getAttribute("datetime"))) / 3600000, most = Number(late.getAttribute("data-hours"));
      late.hidden = hours <= most;
      // So far ahead is no clock that is a little behind.
      ahead.hidden = hours >= -most;
    }
    document.body.classList.toggle("late", cut || !!late && !(late.hidden && ahead.hidden));
  }
  look();
  // A screen that shows the page all day grows older too.
  window.setInterval(look, 60000);
})();
