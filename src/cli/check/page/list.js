
// The list of defects: a click, the arrow keys or a number behind # in the address choose one.
{
  const rows = [...document.querySelectorAll("tr.defect")];
  const said = document.querySelector(".selected");
  const hint = said.textContent;
  let at = -1;

  if (view) {
    document.querySelector(".view").hidden = false;
    document.querySelector(".sides").open = false;
    for (const box of document.querySelectorAll(".kinds input")) {
      box.hidden = false;
      box.addEventListener("change", () => view.show(box.dataset.kind, box.checked));
    }
    view.canvas.addEventListener("webglcontextlost", () => {
      document.querySelector(".view").hidden = true;
      document.querySelector(".missing").hidden = false;
      document.querySelector(".sides").open = true;
    });
    view.redraw();
  } else {
    document.querySelector(".missing").hidden = false;
  }
  document.documentElement.dataset.view = view ? "webgl" : "pictures";

  const address = (hash) => {
    try {
      history.replaceState(null, "", hash);
    } catch {
      // Some browsers refuse it for files; the address is a convenience.
    }
  };
  function choose(next) {
    if (!data.defects[next]) return;
    rows[at]?.removeAttribute("aria-selected");
    at = next;
    rows[at].setAttribute("aria-selected", "true");
    rows[at].scrollIntoView({ block: "nearest" });
    const defect = data.defects[at];
    const kind = data.kinds.find((one) => one.kind === defect.kind);
    const name = defect.name ? ` (${defect.name})` : "";
    said.textContent =
      `${at + 1} of ${data.defects.length}: ${defect.kind.replaceAll("_", " ")} at ${defect.position.map((x) => Number(x.toPrecision(6))).join(", ")}${name}. ` +
      `Effect on the shadow: ${kind.effect}.`;
    view?.choose(defect);
    document.documentElement.dataset.selected = String(at);
    address(`#${at + 1}`);
  }
  function reset() {
    rows[at]?.removeAttribute("aria-selected");
    at = -1;
    said.textContent = hint;
    view?.reset();
    delete document.documentElement.dataset.selected;
    address("#");
  }
  const step = (by) => choose(at < 0 ? (by > 0 ? 0 : rows.length - 1) : (at + by + rows.length) % rows.length);

  rows.forEach((row, index) => row.addEventListener("click", () => choose(index)));
  document.getElementById("reset").addEventListener("click", reset);
  document.getElementById("previous")?.addEventListener("click", () => step(-1));
  document.getElementById("next")?.addEventListener("click", () => step(1));
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const by = { ArrowDown: 1, ArrowRight: 1, ArrowUp: -1, ArrowLeft: -1 }[event.key];
    if (by && rows.length) step(by);
    else if (event.key === "Escape") reset();
    else if (event.key === "Enter" && at >= 0 && !event.target.matches("button, summary, input")) choose(at);
    else return;
    event.preventDefault();
  });

  // What `check --json` would say: the chosen defect, or all that are listed.
  const copy = document.getElementById("copy");
  copy?.addEventListener("click", async () => {
    const plain = ({ view: _, ...rest }) => rest;
    const text = JSON.stringify(at < 0 ? data.defects.map(plain) : plain(data.defects[at]), null, 2);
    try {
      await navigator.clipboard.writeText(text);
    } catch {
      const area = document.createElement("textarea");
      area.value = text;
      document.body.append(area);
      area.select();
      document.execCommand("copy");
      area.remove();
    }
    copy.textContent = "Copied";
    setTimeout(() => (copy.textContent = "Copy as JSON"), 1500);
  });

  const asked = () => choose(Number(location.hash.slice(1)) - 1);
  addEventListener("hashchange", asked);
  if (location.hash) asked();
}
