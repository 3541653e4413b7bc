{
  const MOST_DECODED = 96;
  const PLAY_INTERVAL_MS = 180;
  const decoded = new Map();

  // Pictures are decoded when first shown; the least recently shown are forgotten.
  const decode = (key, address) => {
    let picture = decoded.get(key);
    decoded.delete(key);
    if (!picture) {
      const image = new Image();
      image.src = address;
      picture = image.decode().then(() => image);
    }
    decoded.set(key, picture);
    if (decoded.size > MOST_DECODED) decoded.delete(decoded.keys().next().value);
    return picture;
  };

  const dataOf = (id) => {
    const element = document.getElementById(id);
    return element && JSON.parse(element.textContent);
  };

  const start = (viewer) => {
    const number = viewer.dataset.sequence;
    const { frames, fps, layers } = dataOf(`pictures-${number}`);
    const panes = [...viewer.querySelectorAll(".pane")];
    const slider = viewer.querySelector(".frame-slider");
    const opacity = viewer.querySelector(".opacity-slider");
    const frameNumber = viewer.querySelector(".frame-number b");
    const playButton = viewer.querySelector("[data-play]");
    const video = viewer.querySelector("video");
    let isDrawing = false;
    let isStale = false;
    let timer = 0;

    const chosen = (pane) =>
      [...viewer.querySelectorAll(`input[data-pane="${pane}"]:checked`)].map((input) => Number(input.value));

    const drawPane = async (element, index, place) => {
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
        canvas.dataset.frame = frames[place];
        canvas.setAttribute("aria-label", `frame ${frames[place]}: ${names.join(", ") || "nothing"}`);
        element.querySelector(".pane-caption").textContent = names.join(" + ") || "nothing chosen";
      };
    };

    // While a frame is decoded the slider may move on: then only its last place is drawn next.
    const draw = async () => {
      isStale = isDrawing;
      if (isDrawing) return;
      isDrawing = true;
      const place = Number(slider.value);
      const paint = await Promise.all(panes.map((element, index) => drawPane(element, index, place)));
      for (const paintPane of paint) paintPane();
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

    const play = (isPlaying) => {
      clearInterval(timer);
      timer = isPlaying ? setInterval(step, PLAY_INTERVAL_MS, 1) : 0;
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
    playButton.disabled = frames.length < 2;
    playButton.addEventListener("click", () => play(!timer));
    viewer.addEventListener("change", (event) => {
      if (!("pane" in event.target.dataset)) return;
      markLayers();
      draw();
    });

    if (video) {
      const bytes = Uint8Array.from(atob(dataOf(`video-${number}`)), (character) => character.charCodeAt(0));
      video.addEventListener("loadedmetadata", seekVideo, { once: true });
      video.src = URL.createObjectURL(new Blob([bytes], { type: "video/mp4" }));
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

  // Those of open sections follow when there is time, so that they are there when the page is printed.
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
