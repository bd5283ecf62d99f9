/* Says when the desk does not answer or a session has ended, and sends no form into the void: what was typed stays. */
(function () {
  "use strict";
  var WAIT = 15000;
  var sure = null, asking = false;

  function tell(what) {
    var place = document.getElementById("lost"), text = what && document.getElementById("told-" + what);
    place.replaceChildren();
    if (text) { place.appendChild(text.content.cloneNode(true)); }
  }

  document.addEventListener("htmx:sendError", function () { tell("lost"); });
  document.addEventListener("htmx:timeout", function () { tell("lost"); });
  document.addEventListener("htmx:responseError", function (event) {
    tell(event.detail.xhr.status === 401 ? "ended" : "lost");
  });
  document.addEventListener("htmx:afterRequest", function (event) { if (event.detail.successful) { tell(""); } });

  document.addEventListener("submit", function (event) {
    var form = event.target, button = event.submitter;
    if (sure === form || form.method !== "post" || !form.hasAttribute("data-kept")) { sure = null; return; }
    event.preventDefault();
    if (asking) { return; }
    asking = true;
    var stop = new AbortController(), clock = setTimeout(function () { stop.abort(); }, WAIT);
    fetch("/here", { cache: "no-store", redirect: "manual", signal: stop.signal }).then(function (answer) {
      if (answer.status === 401 || answer.type === "opaqueredirect") { tell("ended"); return; }
      if (!answer.ok) { throw new Error(answer.status); }
      return answer.text().then(function (token) {
        if (form.elements.token) { form.elements.token.value = token; }
        tell("");
        sure = form;
        form.requestSubmit(button);
      });
    }).catch(function () { tell("lost"); }).finally(function () { clearTimeout(clock); asking = false; });
  });
})();
