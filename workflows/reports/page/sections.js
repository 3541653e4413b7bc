{
  const sequences = [...document.querySelectorAll("details.sequence")];
  const links = [...document.querySelectorAll(".sidebar a[href^='#']")];

  const open = () => {
    const target = location.hash.length > 1 && document.getElementById(decodeURIComponent(location.hash.slice(1)));
    if (target && target.matches("details.sequence")) target.open = true;
  };
  addEventListener("hashchange", open);
  for (const link of document.querySelectorAll("a[href^='#sequence-']")) {
    link.addEventListener("click", () => {
      document.getElementById(link.hash.slice(1)).open = true;
    });
  }
  open();

  for (const [id, isOpen] of [["open-all", true], ["close-all", false]]) {
    document.getElementById(id)?.addEventListener("click", () => {
      for (const sequence of sequences) sequence.open = isOpen;
    });
  }

  const filter = document.getElementById("filter");
  filter?.addEventListener("input", () => {
    const wanted = filter.value.trim().toLowerCase();
    let count = 0;
    for (const sequence of sequences) {
      const isWanted = sequence.dataset.name.toLowerCase().includes(wanted);
      count += isWanted;
      sequence.hidden = !isWanted;
      document.querySelector(`.jump [data-sequence="${sequence.dataset.sequence}"]`).hidden = !isWanted;
    }
    document.getElementById("filter-count").textContent = wanted ? `${count} of ${sequences.length}` : "";
  });

  // The link of what is being read is marked: the last section that begins above the upper third of the window.
  const targets = links.map((link) => document.getElementById(link.hash.slice(1)));
  let isDue = false;
  const mark = () => {
    isDue = false;
    let current = -1;
    targets.forEach((target, index) => {
      if (!target.hidden && target.getBoundingClientRect().top < innerHeight / 3) current = index;
    });
    links.forEach((link, index) => {
      if (index === current) link.setAttribute("aria-current", "location");
      else link.removeAttribute("aria-current");
    });
  };
  const markSoon = () => {
    if (!isDue) requestAnimationFrame(mark);
    isDue = true;
  };
  addEventListener("scroll", markSoon, { passive: true });
  addEventListener("resize", markSoon);
  mark();
}
