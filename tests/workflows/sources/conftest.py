"""Small real files: images by OpenCV and Pillow, videos by FFmpeg."""

import av
import cv2
import numpy as np
import pytest


@pytest.fixture(scope="session")
def picture() -> np.ndarray:
    """Return uint8 (48, 64, 3) RGB without any symmetry, smooth enough for lossy coding."""
    y, x = np.mgrid[:48, :64]
    return np.stack([x * 3, y * 5, (x + y) * 2], axis=-1).astype(np.uint8)


@pytest.fixture
def write_image():
    """Return a function that writes an RGB or grey array to a path by its suffix."""

    def write(path, image):
        path.parent.mkdir(parents=True, exist_ok=True)
        bgr = image[..., ::-1] if image.ndim == 3 and image.shape[2] == 3 else image
        cv2.imencode(path.suffix, np.ascontiguousarray(bgr))[1].tofile(path)
        return str(path)

    return write


@pytest.fixture
def write_video():
    """Return a function that writes RGB frames as H.264; `times` are their time stamps in 1/25 s."""

    def write(path, frames, times=None, codec="libx264", **options):
        with av.open(str(path), "w", options={"movflags": "faststart"} if path.suffix == ".mp4" else {}) as container:
            stream = container.add_stream(codec, rate=25, options=options)
            stream.height, stream.width = frames[0].shape[:2]
            stream.pix_fmt = "yuv420p"
            for number, image in enumerate(frames):
                frame = av.VideoFrame.from_ndarray(np.ascontiguousarray(image), format="rgb24")
                frame.pts = number if times is None else times[number]
                container.mux(stream.encode(frame))
            container.mux(stream.encode(None))
        return str(path)

    return write
