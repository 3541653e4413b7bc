"""Valid files of pictures, arrays and videos, before they are damaged."""

import io
import struct
from collections.abc import Callable
from pathlib import Path

import av
import cv2
import numpy as np
from PIL import Image

HEIGHT, WIDTH, NUM_FRAMES = 24, 32, 4
SHAPE = (HEIGHT, WIDTH)
_DICE = np.random.default_rng(0)
_NOISE = _DICE.integers(0, 256, (240, 320, 3)).astype(np.uint8)
PICTURE = cv2.GaussianBlur(_NOISE, (0, 0), 1.5)[:HEIGHT, :WIDTH]
LABELS = (np.indices((NUM_FRAMES, *SHAPE)).sum(axis=0) // 12 % 4).astype(np.uint8)
FLOW = _DICE.normal(0, 5, (*SHAPE, 2)).astype(np.float32)
DEPTH = np.linspace(0, 1, HEIGHT * WIDTH).reshape(SHAPE)
POINTS = _DICE.uniform(0, 20, (5, NUM_FRAMES, 2))
SEEN = _DICE.random((5, NUM_FRAMES)) < 0.8


def saved(save: Callable, *arguments, **named) -> bytes:
    """Return the bytes that a function writes to a stream."""
    stream = io.BytesIO()
    save(stream, *arguments, **named)
    return stream.getvalue()


def frame_pngs() -> tuple[bytes, ...]:
    """Return PNGs: colours, grey, 16 bits, a palette, alpha; and one of the size of real frames."""
    kinds = [Image.fromarray(PICTURE).convert(mode) for mode in ("RGB", "L", "P", "RGBA", "1")]
    return (
        *(saved(image.save, "PNG") for image in kinds),
        cv2.imencode(".png", PICTURE.astype(np.uint16) * 257)[1].tobytes(),
        saved(Image.fromarray(_NOISE).save, "PNG"),
    )


def frame_jpegs() -> tuple[bytes, ...]:
    """Return JPEGs: baseline, progressive, grey, CMYK, with restarts, rotated by EXIF."""
    image, exif = Image.fromarray(PICTURE), Image.Exif()
    exif[0x0112] = 6
    return (
        saved(image.save, "JPEG"),
        saved(image.save, "JPEG", progressive=True),
        saved(image.convert("L").save, "JPEG"),
        saved(image.convert("CMYK").save, "JPEG"),
        saved(image.save, "JPEG", restart_marker_blocks=1),
        saved(image.save, "JPEG", exif=exif, comment=b"a comment"),
    )


def other_frames() -> tuple[bytes, ...]:
    """Return bitmaps, TIFF and WebP."""
    image = Image.fromarray(PICTURE)
    return (
        saved(image.save, "BMP"),
        saved(image.convert("P").save, "BMP"),
        saved(image.save, "TIFF"),
        *(saved(image.save, "TIFF", compression=method) for method in ("tiff_lzw", "tiff_deflate", "jpeg")),
        saved(image.convert("L").save, "TIFF"),
        saved(image.save, "WEBP"),
        saved(image.save, "WEBP", lossless=True),
    )


def label_pngs() -> tuple[bytes, ...]:
    """Return a palette, one with transparent colours, grey, 16 bits, 1 bit; and a large one."""
    palette = Image.fromarray(LABELS[0]).convert("P")
    palette.putpalette([0, 0, 0, 9, 9, 9] * 128)
    large = cv2.resize(_NOISE[..., 0] // 64, None, fx=2, fy=2, interpolation=cv2.INTER_NEAREST)
    return (
        saved(palette.save, "PNG"),
        saved(palette.save, "PNG", transparency=2),
        saved(Image.fromarray(LABELS[0]).save, "PNG"),
        cv2.imencode(".png", LABELS[0].astype(np.uint16))[1].tobytes(),
        saved(Image.fromarray(LABELS[0] > 0).save, "PNG"),
        saved(Image.fromarray(large).save, "PNG"),
    )


def flow_pngs() -> tuple[bytes, ...]:
    """Return flow in KITTI's 16-bit format, small and large."""
    values = np.dstack([np.ones(SHAPE), FLOW * 64 + 2**15]).astype(np.uint16)
    large = np.dstack([np.ones((240, 320)), _NOISE[..., :2] * 200.0]).astype(np.uint16)
    return tuple(cv2.imencode(".png", image)[1].tobytes() for image in (values, large))


def flo_files() -> tuple[bytes, ...]:
    """Return flow in Middlebury's format."""
    return (b"PIEH" + struct.pack("<ii", WIDTH, HEIGHT) + FLOW.tobytes(),)


def depth_pngs() -> tuple[bytes, ...]:
    """Return 16-bit grey pictures, small and large."""
    large = cv2.resize((DEPTH * 65535).astype(np.uint16), (320, 240)) ^ _NOISE[..., 0]
    return tuple(cv2.imencode(".png", image)[1].tobytes() for image in ((DEPTH * 65535).astype(np.uint16), large))


def pfm_files() -> tuple[bytes, ...]:
    """Return PFM files in both byte orders."""
    head = f"Pf\n{WIDTH} {HEIGHT}\n".encode()
    return head + b"-1\n" + LABELS[0].astype("<f4").tobytes(), head + b"1.0\n" + LABELS[0].astype(">f4").tobytes()


def npy_files(*arrays: np.ndarray) -> tuple[bytes, ...]:
    """Return each array in C and in Fortran order."""
    return tuple(
        saved(np.save, order(array)) for array in arrays for order in (np.ascontiguousarray, np.asfortranarray)
    )


def npz_files(**arrays: np.ndarray) -> tuple[bytes, ...]:
    """Return archives, stored and compressed."""
    return saved(np.savez, **arrays), saved(np.savez_compressed, **arrays)


def mat_files() -> tuple[bytes, ...]:
    """Return labelled trajectories, plain and compressed."""
    from scipy.io import savemat

    sparse = np.concatenate([POINTS, np.ones((*SEEN.shape, 1))], axis=-1).transpose(2, 0, 1)
    data = {"ySparse": sparse, "visibleSparse": SEEN.astype(np.uint8), "GtLabel": np.uint8([[1], [1], [2], [2], [3]])}
    return tuple(saved(savemat, {"Data": data}, do_compression=packed) for packed in (False, True))


_VIDEOS = {
    "a.mp4": ("libx264", "yuv420p", {"bf": "2"}, {"movflags": "faststart"}),
    "b.mp4": ("mpeg4", "yuv420p", {}, {}),
    "c.mp4": ("libx264", "yuv420p", {}, {"movflags": "frag_keyframe+empty_moov"}),
    "a.mov": ("mjpeg", "yuvj420p", {}, {}),
    "a.mkv": ("ffv1", "bgr0", {}, {}),
    "b.mkv": ("libx264", "yuv420p10le", {}, {}),
    "a.webm": ("libvpx-vp9", "yuv420p", {"deadline": "realtime"}, {}),
    "a.avi": ("mpeg4", "yuv420p", {}, {}),
    "a.ts": ("mpeg2video", "yuv420p", {}, {}),
    "a.flv": ("flv", "yuv420p", {}, {}),
    "a.h264": ("libx264", "yuv420p", {}, {}),
    "a.gif": ("gif", "rgb8", {}, {}),
}


def video_files(folder: Path, *suffixes: str) -> tuple[bytes, ...]:
    """Return videos in containers of these suffixes; `folder` holds them temporarily.

    Codecs that this build lacks are left out.
    """
    contents = []
    for name, (codec, pixels, options, muxer) in _VIDEOS.items():
        if name.endswith(suffixes) and codec in av.codecs_available:
            path = folder / name
            _write_video(path, codec, pixels, options, muxer)
            contents.append(path.read_bytes())
            path.unlink()
    return tuple(contents)


def _write_video(path: Path, codec: str, pixels: str, options: dict[str, str], muxer: dict[str, str]) -> None:
    with av.open(str(path), "w", options=muxer) as container:
        container.metadata["title"] = "a title"
        stream = container.add_stream(codec, rate=25, options=options)
        stream.height, stream.width, stream.pix_fmt = 2 * HEIGHT, 2 * WIDTH, pixels
        stream.codec_context.thread_count = 1
        for number in range(NUM_FRAMES):
            shifted = np.ascontiguousarray(_NOISE[number : number + 2 * HEIGHT, : 2 * WIDTH] // 3)
            frame = av.VideoFrame.from_ndarray(shifted, format="rgb24").reformat(format=pixels)
            frame.pts = number
            container.mux(stream.encode(frame))
        container.mux(stream.encode(None))
