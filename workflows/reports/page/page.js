"use strict";
document.documentElement.classList.add("js");

// Light and dark colours.
{
  const button = document.getElementById("theme-toggle");
  const prefersDark = matchMedia("(prefers-color-scheme: dark)");

  // A page opened from a file may have no storage; the choice is then lost when the page is closed.
  const storage = (use) => {
    try {
      return use(localStorage);
    } catch {
      return null;
    }
  };

  const theme = () => document.documentElement.dataset.theme ?? (prefersDark.matches ? "dark" : "light");
  const label = () => {
    const other = theme() === "dark" ? "light" : "dark";
    button.textContent = other === "dark" ? "Dark" : "Light";
    button.setAttribute("aria-label", `switch to ${other} colours`);
  };

  const kept = storage((store) => store.getItem("moseg-theme"));
  if (kept === "light" || kept === "dark") document.documentElement.dataset.theme = kept;
  label();
  prefersDark.addEventListener("change", label);
  button.addEventListener("click", () => {
    const other = theme() === "dark" ? "light" : "dark";
    document.documentElement.dataset.theme = other;
    storage((store) => store.setItem("moseg-theme", other));
    label();
  });
}

// Sections: opened, filtered and marked in the sidebar.
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

  // The marked link is that of the last section that begins in the upper third of the window or above.
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

// Viewers: frames, layers, playing and the video.
{
  const MAX_DECODED = 96;
  const PLAY_INTERVAL_MS = 180;
  const decoded = new Map();

  // Pictures are decoded when first shown; the least recently shown are dropped.
  const decode = (key, address) => {
    let picture = decoded.get(key);
    decoded.delete(key);
    if (!picture) {
      const image = new Image();
      image.src = address;
      picture = image.decode().then(() => image);
      picture.catch(() => decoded.get(key) === picture && decoded.delete(key));
    }
    decoded.set(key, picture);
    if (decoded.size > MAX_DECODED) decoded.delete(decoded.keys().next().value);
    return picture;
  };

  const dataOf = (id) => {
    const element = document.getElementById(id);
    return element && JSON.parse(element.textContent);
  };

  const bytesOf = (id) => Uint8Array.from(atob(dataOf(id)), (character) => character.charCodeAt(0));
  const sliceOf = (bytes, [start, size]) => bytes.subarray(start, start + size);

  const start = (viewer) => {
    const number = viewer.dataset.sequence;
    const { frames, pictured, fps, layers, archive, places } = dataOf(`pictures-${number}`);
    const layerPlaces = new Map(pictured.map((frame, place) => [frame, place]));
    const maskPlaces = new Map(places.map(([frame, start, size]) => [frame, [start, size]]));
    const panes = [...viewer.querySelectorAll(".pane")];
    const slider = viewer.querySelector(".frame-slider");
    const opacity = viewer.querySelector(".opacity-slider");
    const frameNumber = viewer.querySelector(".frame-number b");
    const playButton = viewer.querySelector("[data-play]");
    const video = viewer.querySelector("video");
    const jumps = [...viewer.querySelectorAll(".timelines [data-frame]")];
    const playheads = [...viewer.querySelectorAll(".playhead")];
    let maskBytes = null;
    let isDrawing = false;
    let isStale = false;
    let timer = 0;

    const masks = () => (maskBytes ??= bytesOf(`masks-${number}`));

    const chosen = (pane) =>
      [...viewer.querySelectorAll(`input[data-pane="${pane}"]:checked`)].map((input) => Number(input.value));

    const drawPane = async (element, index, place, frame) => {
      const shown = chosen(index);
      const isBase = (layer) => viewer.querySelector(`input[type="radio"][value="${layer}"]`) !== null;
      const pictures = await Promise.all(
        shown.map((layer) => {
          const address = layers[layer].pictures[place];
          return address && decode(`${number}/${layer}/${place}`, address);
        }),
      );
      const names = shown.map((layer, at) => layers[layer].name + (pictures[at] ? "" : " (none for this frame)"));
      return () => {
        const canvas = element.querySelector("canvas");
        const present = pictures.filter(Boolean);
        if (present.length) {
          canvas.width = Math.max(...present.map((picture) => picture.naturalWidth));
          canvas.height = Math.max(...present.map((picture) => picture.naturalHeight));
        }
        const context = canvas.getContext("2d");
        context.clearRect(0, 0, canvas.width, canvas.height);
        context.imageSmoothingQuality = "high";
        pictures.forEach((picture, at) => {
          if (!picture) return;
          context.globalAlpha = isBase(shown[at]) ? 1 : opacity.value / 100;
          context.drawImage(picture, 0, 0, canvas.width, canvas.height);
        });
        canvas.dataset.frame = frame;
        canvas.setAttribute("aria-label", `frame ${frame}: ${names.join(", ") || "nothing"}`);
        element.querySelector(".pane-caption").textContent = names.join(" + ") || "nothing chosen";
      };
    };

    // Resolves when the video shows a frame; false where there is no video or the browser cannot decode it.
    const showInVideo = (frame) =>
      new Promise((resolve) => {
        if (!video || !fps || video.error) {
          resolve(false);
          return;
        }
        video.pause();
        video.addEventListener("error", () => resolve(false), { once: true });
        const seek = () => {
          // An earlier seek may still report its end, while the video shows the frame of that one.
          const settle = () => {
            if (video.seeking) return;
            video.removeEventListener("seeked", settle);
            resolve(true);
          };
          video.addEventListener("seeked", settle);
          video.currentTime = Math.min((frame + 0.5) / fps, video.duration);
        };
        if (video.readyState >= 1) seek();
        else video.addEventListener("loadedmetadata", seek, { once: true });
      });

    const paint = (element, source, width, height, caption, frame) => {
      const canvas = element.querySelector("canvas");
      if (source) [canvas.width, canvas.height] = [width, height];
      const context = canvas.getContext("2d");
      context.clearRect(0, 0, canvas.width, canvas.height);
      if (source) context.drawImage(source, 0, 0, width, height);
      canvas.dataset.frame = frame;
      canvas.setAttribute("aria-label", `frame ${frame}: ${caption}`);
      element.querySelector(".pane-caption").textContent = caption;
    };

    // A frame without pictures of layers: the video beside the mask.
    const drawBetween = async (frame) => {
      const [hasVideo, mask] = await Promise.all([
        showInVideo(frame),
        maskPlaces.has(frame) && createImageBitmap(new Blob([sliceOf(masks(), maskPlaces.get(frame))], { type: "image/png" })),
      ]);
      return () => {
        const none = "(none for this frame)";
        const [left, right] = panes;
        if (hasVideo) paint(left, video, video.videoWidth, video.videoHeight, "video", frame);
        else paint(left, null, 0, 0, `video ${none}`, frame);
        if (mask) paint(right, mask, mask.width, mask.height, "mask", frame);
        else paint(right, null, 0, 0, `mask ${none}`, frame);
      };
    };

    // The slider may move while a frame is decoded: only its last place is drawn next.
    const draw = async () => {
      isStale = isDrawing;
      if (isDrawing) return;
      isDrawing = true;
      const frame = frames[Number(slider.value)];
      const place = layerPlaces.get(frame);
      try {
        const painters = place === undefined
          ? [await drawBetween(frame)]
          : await Promise.all(panes.map((element, index) => drawPane(element, index, place, frame)));
        for (const painter of painters) painter();
      } catch {
        // A picture that cannot be decoded: the others must not wait for it.
        for (const element of panes) paint(element, null, 0, 0, "a picture that cannot be read", frame);
      }
      isDrawing = false;
      if (isStale) draw();
    };

    const seekVideo = () => {
      if (!video || !fps || !video.paused || video.readyState < 1) return;
      video.currentTime = Math.min((frames[Number(slider.value)] + 0.5) / fps, video.duration);
    };

    const show = () => {
      const frame = frames[Number(slider.value)];
      frameNumber.textContent = frame;
      slider.setAttribute("aria-valuetext", `frame ${frame}`);
      for (const playhead of playheads) {
        playhead.setAttribute("x1", frame + 0.5);
        playhead.setAttribute("x2", frame + 0.5);
      }
      for (const jump of jumps) {
        if (Number(jump.dataset.frame) === frame) jump.setAttribute("aria-current", "true");
        else jump.removeAttribute("aria-current");
      }
      draw();
      seekVideo();
    };

    const markLayers = () => {
      for (const layer of viewer.querySelectorAll(".layer")) {
        layer.classList.toggle("is-off", layer.querySelector("input:checked") === null);
      }
    };

    const step = (by) => {
      slider.value = (Number(slider.value) + by + frames.length) % frames.length;
      show();
    };

    // The next place in a direction that has pictures, round the end.
    const stepPictured = (by) => {
      const count = frames.length;
      let place = Number(slider.value);
      do place = (place + by + count) % count;
      while (!layerPlaces.has(frames[place]));
      slider.value = place;
      show();
    };

    // The slider's place nearest to a frame: a long sequence has places for every nth frame only.
    const goTo = (frame) => {
      play(false);
      let nearest = 0;
      frames.forEach((each, place) => {
        if (Math.abs(each - frame) < Math.abs(frames[nearest] - frame)) nearest = place;
      });
      slider.value = nearest;
      show();
    };

    const play = (isPlaying) => {
      clearInterval(timer);
      timer = isPlaying ? setInterval(stepPictured, PLAY_INTERVAL_MS, 1) : 0;
      playButton.setAttribute("aria-pressed", String(isPlaying));
      playButton.setAttribute("aria-label", isPlaying ? "pause" : "play");
    };

    slider.addEventListener("input", () => {
      play(false);
      show();
    });
    opacity.addEventListener("input", draw);
    for (const button of viewer.querySelectorAll("[data-step]")) {
      button.disabled = frames.length < 2;
      button.addEventListener("click", () => {
        play(false);
        step(Number(button.dataset.step));
      });
    }
    for (const button of viewer.querySelectorAll("[data-pictured]")) {
      button.addEventListener("click", () => {
        play(false);
        stepPictured(Number(button.dataset.pictured));
      });
    }
    for (const jump of jumps) jump.addEventListener("click", () => goTo(Number(jump.dataset.frame)));
    for (const area of viewer.querySelectorAll(".area")) {
      area.addEventListener("click", (event) => {
        const box = area.getBoundingClientRect();
        goTo(Math.floor(((event.clientX - box.left) / box.width) * Number(area.dataset.frames)));
      });
    }
    // The tab key stops once at each row of thumbnails; arrows move within it.
    for (const row of viewer.querySelectorAll(".thumbnails")) {
      const thumbnails = [...row.querySelectorAll("button")];
      thumbnails.forEach((each, place) => {
        each.tabIndex = place === 0 ? 0 : -1;
      });
      row.addEventListener("keydown", (event) => {
        const at = thumbnails.indexOf(event.target);
        const next = { ArrowRight: at + 1, ArrowLeft: at - 1, Home: 0, End: thumbnails.length - 1 }[event.key];
        if (at < 0 || !thumbnails[next]) return;
        event.preventDefault();
        thumbnails[at].tabIndex = -1;
        thumbnails[next].tabIndex = 0;
        thumbnails[next].focus();
      });
    }
    viewer.querySelector("[data-download]")?.addEventListener("click", () => {
      const link = document.createElement("a");
      link.href = URL.createObjectURL(new Blob([masks()], { type: "application/zip" }));
      link.download = archive;
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 60000);
    });
    playButton.disabled = pictured.length < 2;
    playButton.addEventListener("click", () => play(!timer));
    viewer.addEventListener("change", (event) => {
      if (!("pane" in event.target.dataset)) return;
      markLayers();
      draw();
    });

    if (video) {
      video.addEventListener("loadedmetadata", seekVideo, { once: true });
      video.src = URL.createObjectURL(new Blob([bytesOf(`video-${number}`)], { type: "video/mp4" }));
    }
    markLayers();
    show();
  };

  const waiting = new Set(document.querySelectorAll(".viewer"));
  const startOnce = (viewer) => {
    if (waiting.delete(viewer)) start(viewer);
  };
  const seen = new IntersectionObserver((entries) => {
    for (const entry of entries) if (entry.isIntersecting) startOnce(entry.target);
  }, { rootMargin: "800px" });
  for (const viewer of waiting) seen.observe(viewer);

  // Viewers of open sections start when the browser is idle, so that they are complete when the page is printed.
  const whenIdle = globalThis.requestIdleCallback ?? ((work) => setTimeout(work, 200));
  const startNext = () => {
    const next = [...waiting].find((viewer) => viewer.offsetParent !== null);
    if (!next) return;
    startOnce(next);
    whenIdle(startNext);
  };
  for (const section of document.querySelectorAll("details.sequence")) {
    section.addEventListener("toggle", () => whenIdle(startNext));
  }
  whenIdle(startNext);
}

// Tabs of variants.
for (const list of document.querySelectorAll("[role=tablist]")) {
  const tabs = [...list.querySelectorAll("[role=tab]")];
  const panelOf = (tab) => document.getElementById(tab.getAttribute("aria-controls"));

  const select = (chosen) => {
    for (const tab of tabs) {
      tab.setAttribute("aria-selected", String(tab === chosen));
      tab.tabIndex = tab === chosen ? 0 : -1;
      panelOf(tab).hidden = tab !== chosen;
    }
  };

  list.addEventListener("click", (event) => {
    const tab = event.target.closest("[role=tab]");
    if (tab) select(tab);
  });
  list.addEventListener("keydown", (event) => {
    const at = tabs.indexOf(event.target);
    const next = { ArrowRight: at + 1, ArrowLeft: at - 1, Home: 0, End: tabs.length - 1 }[event.key];
    if (next === undefined) return;
    event.preventDefault();
    const tab = tabs[(next + tabs.length) % tabs.length];
    select(tab);
    tab.focus();
  });
  select(tabs[0]);
}

// Matrices: the cell under the pointer or the focus is read out.
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

  // The tab key stops once at each matrix; arrows move within it.
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
