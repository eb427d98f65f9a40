// Shows what is chosen; without this, everything is shown.
(() => {
  const bar = document.querySelector(".filter");
  const words = bar.querySelector("[type=search]");
  const count = bar.querySelector("output");
  const all = (selector, inside = document) => [...inside.querySelectorAll(selector)];
  const show = () => {
    const open = bar.querySelector("[name=show]:checked").value === "open";
    const asked = words.value.trim().toLowerCase();
    let shown = 0;
    for (const group of all("section.group")) {
      let some = false;
      for (const item of all("section.case", group)) {
        const about = `${item.id} ${item.querySelector("h3").textContent}`.toLowerCase();
        item.hidden = (open && item.dataset.verdict === "passed") || !about.includes(asked);
        for (const row of all("[data-row]", item)) row.hidden = open && row.dataset.row === "passed";
        shown += !item.hidden;
        some ||= !item.hidden;
      }
      group.hidden = !some;
    }
    for (const entry of all(".contents li")) {
      entry.hidden = document.getElementById(entry.dataset.case).hidden;
    }
    count.textContent = `${shown} of ${all("section.case").length} cases`;
  };
  // A link to a case that is hidden shows all again, and then goes there.
  const arrive = () => {
    const target = location.hash && document.getElementById(location.hash.slice(1));
    if (target && target.closest("[hidden]")) {
      bar.querySelector("[value=all]").checked = true;
      words.value = "";
      show();
      target.scrollIntoView();
    }
  };
  bar.hidden = false;
  bar.addEventListener("input", show);
  addEventListener("hashchange", arrive);
  show();
  arrive();
})();
