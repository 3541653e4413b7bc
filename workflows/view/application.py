"""The addresses of the server: the page's files, pictures of what is open, and changes.

No part of an address becomes a path: files of the page are looked up by name, frames and objects by number.
"""

import asyncio
import json
import traceback
from collections.abc import Callable, Sequence
from contextlib import asynccontextmanager
from functools import partial, wraps
from pathlib import Path
from typing import Any
from urllib.parse import unquote

from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect, Request
from starlette.responses import JSONResponse, Response, StreamingResponse
from starlette.routing import Route

from moseg.schemas.errors import CorruptArtifactError, InputError, MissingArtifactError, MosegError, StoreError
from moseg.workflows.reports.content import Picture
from moseg.workflows.view.correction_history import StaleEditError
from moseg.workflows.view.frame_pictures import draw_thumbnail, encode_jpeg, pack_labels
from moseg.workflows.view.opened import ExportChoices
from moseg.workflows.view.page_files import INDEX, page_files
from moseg.workflows.view.page_state import describe_grid, describe_matrices, describe_moment, find_tag
from moseg.workflows.view.shown_result import ShownResult
from moseg.workflows.view.uploads import receive_video, remove_video
from moseg.workflows.view.view_session import Opening, ViewSession, in_words

MAX_REQUEST_BYTES = 4 * 2**20
"""Of a change: a stroke has some thousand points."""
KEPT = {"cache-control": "private, max-age=31536000, immutable"}
"""For pictures: what one address shows never changes."""
BAD_REQUEST, CONFLICT, FAULT = 400, 409, 500


class ViewApplication:
    """The addresses of one session.

    Parameters
    ----------
    session : ViewSession
    open_video : function of a path
        Returns the opening of a video that a page has sent.
    open_run : function of a name
        Returns the opening of a run of the store; raises InputError if there is none.
    list_runs : function without arguments
        Returns the runs that can be opened, as JSON.
    """

    def __init__(
        self,
        session: ViewSession,
        open_video: Callable[[Path], Opening],
        open_run: Callable[[str], Opening],
        list_runs: Callable[[], Sequence[dict]],
    ):
        self._session = session
        self._open_video, self._open_run, self._list_runs = open_video, open_run, list_runs
        self._runs: list[dict] | None = None
        # What fills the page beside the picture of the frame is made one at a time, so that a change need not wait.
        self._aside = asyncio.Lock()

    def routes(self) -> Starlette:
        """Return the ASGI application."""
        paths = {
            "/": ("GET", self._index),
            "/state": ("GET", self._state),
            "/events": ("GET", self._events),
            "/frames/{frame:int}": ("GET", self._frame),
            "/labels/{key}/{frame:int}": ("GET", self._labels),
            "/proposals/{frame:int}": ("GET", self._proposals),
            "/cues/{number:int}/key": ("GET", self._cue_key),
            "/cues/{number:int}/{frame:int}": ("GET", self._cue),
            "/thumbnails/{identity:int}/{frame:int}": ("GET", self._thumbnail),
            "/grid/{key}": ("GET", self._grid),
            "/matrices/{key}": ("GET", self._matrices),
            "/edits": ("POST", self._edit),
            "/settings": ("POST", self._set),
            "/undo": ("POST", self._undo),
            "/redo": ("POST", self._redo),
            "/export": ("POST", self._export),
            "/open": ("POST", self._open),
            "/retry": ("POST", self._retry),
            "/upload": ("PUT", self._upload),
            "/{name}": ("GET", self._page_file),
        }

        @asynccontextmanager
        async def lifespan(application):
            self._session.events.attach()
            yield

        routes = [Route(path, _answering(call), methods=[method]) for path, (method, call) in paths.items()]
        return Starlette(routes=routes, lifespan=lifespan)

    async def _index(self, request: Request) -> Response:
        content, media_type = page_files()[INDEX]
        return Response(content, media_type=media_type)

    async def _page_file(self, request: Request) -> Response:
        found = page_files().get(request.path_params["name"])
        if found is None:
            raise HTTPException(404, "no such page")
        return Response(found.content, media_type=found.media_type)

    async def _state(self, request: Request) -> Response:
        return JSONResponse(await self._describe())

    async def _describe(self) -> dict[str, Any]:
        runs: list[dict] = []
        if self._session.moment.phase == "empty":
            if self._runs is None:
                self._runs = list(await run_in_threadpool(self._list_runs))
            runs = self._runs
        return await run_in_threadpool(describe_moment, self._session, runs)

    async def _events(self, request: Request) -> Response:
        return StreamingResponse(self._session.events.stream(), media_type="text/event-stream")

    async def _frame(self, request: Request) -> Response:
        frame = request.path_params["frame"]
        return await self._draw(lambda shown: Response(encode_jpeg(shown.image(frame)), media_type="image/jpeg"), frame)

    async def _proposals(self, request: Request) -> Response:
        frame = request.path_params["frame"]
        return await self._draw(lambda shown: _send_labels(shown.proposals(frame)), frame)

    async def _labels(self, request: Request) -> Response:
        frame = request.path_params["frame"]
        return await self._draw(lambda shown: _send_labels(shown.labels(frame)), frame, request.path_params["key"])

    async def _thumbnail(self, request: Request) -> Response:
        frame, identity = request.path_params["frame"], request.path_params["identity"]

        def draw(shown: ShownResult) -> Response:
            drawn = draw_thumbnail(shown, identity, frame)
            return Response(status_code=204) if drawn is None else Response(drawn, media_type="image/jpeg")

        async with self._aside:
            response = await self._draw(draw, frame)
        shown, tag = self._session.moment.shown, request.query_params.get("of")
        if tag != await run_in_threadpool(find_tag, self._session.areas, shown, identity):
            # The result has changed since the page asked for it.
            response.headers["cache-control"] = "no-store"
        return response

    async def _cue_key(self, request: Request) -> Response:
        number = self._cue_number(request)
        return await self._draw(lambda shown: _send_picture(self._session.cues.key(number)))

    async def _cue(self, request: Request) -> Response:
        number, frame = self._cue_number(request), request.path_params["frame"]
        return await self._draw(lambda shown: _send_picture(self._session.cues.draw(number, frame)), frame)

    def _cue_number(self, request: Request) -> int:
        number = request.path_params["number"]
        if number >= len(self._session.moment.cues):
            raise HTTPException(404, "no such cue")
        return number

    async def _grid(self, request: Request) -> Response:
        def describe(shown: ShownResult) -> Response:
            return JSONResponse(describe_grid(self._session.areas, shown))

        async with self._aside:
            return await self._draw(describe, key=request.path_params["key"])

    async def _matrices(self, request: Request) -> Response:
        return await self._draw(lambda shown: JSONResponse(describe_matrices(shown)), key=request.path_params["key"])

    async def _draw(
        self, draw: Callable[[ShownResult], Response], frame: int | None = None, key: str | None = None
    ) -> Response:
        """Return what `draw` makes of the result under a key, of the one now by default; 404 where it is not there.

        What is damaged or missing in the store is computed again, once.
        """
        shown = self._session.moment.shown if key is None else self._session.shown(key)
        if shown is None or (frame is not None and frame >= shown.num_frames):
            raise HTTPException(404, "no such result, or no such frame")
        try:
            response = await run_in_threadpool(draw, shown)
        except (CorruptArtifactError, MissingArtifactError) as error:
            await asyncio.wrap_future(self._session.repair(error))
            response = await run_in_threadpool(draw, shown)
        response.headers.update(KEPT)
        return response

    async def _edit(self, request: Request) -> Response:
        content = await _read_content(request)
        return await self._change(self._session.edit(_revision(content), content.get("edit")))

    async def _set(self, request: Request) -> Response:
        content = await _read_content(request)
        values = (str(content.get("name")), content.get("value"), content.get("gesture"))
        return await self._change(self._session.set(_revision(content), *values))

    async def _undo(self, request: Request) -> Response:
        return await self._change(self._session.step(_revision(await _read_content(request)), -1))

    async def _redo(self, request: Request) -> Response:
        return await self._change(self._session.step(_revision(await _read_content(request)), 1))

    async def _change(self, future) -> Response:
        await asyncio.wrap_future(future)
        return JSONResponse(await self._describe())

    async def _export(self, request: Request) -> Response:
        content = await _read_content(request)
        written = await asyncio.wrap_future(self._session.export(_revision(content), _read_choices(content)))
        num_frames = self._session.moment.shown.num_frames
        return JSONResponse({"written": list(map(str, written)), "numFrames": num_frames})

    async def _open(self, request: Request) -> Response:
        run = str((await _read_content(request)).get("run"))
        self._session.open(run, await run_in_threadpool(self._open_run, run), is_only=False)
        return JSONResponse({})

    async def _retry(self, request: Request) -> Response:
        await _read_content(request)
        self._session.retry()
        return JSONResponse({})

    async def _upload(self, request: Request) -> Response:
        if self._session.moment.phase != "empty":
            raise InputError("a result is open already", expected="another `moseg view`")
        given = unquote(request.headers.get("x-file-name", ""), errors="replace")
        path = await receive_video(request.stream(), given, self._session.out)
        refuse = partial(remove_video, path)
        try:
            self._session.open(path.name, self._open_video(path), is_only=False, refuse=refuse)
        except InputError:
            # Another page was faster.
            refuse()
            raise
        return JSONResponse({})


def _answering(call: Callable) -> Callable:
    """Return an endpoint that answers errors by one line, as JSON."""

    @wraps(call)
    async def endpoint(request: Request) -> Response:
        try:
            return await call(request)
        except HTTPException as error:
            return JSONResponse({"message": error.detail}, error.status_code)
        except ClientDisconnect:
            return Response(status_code=BAD_REQUEST)
        except StaleEditError as error:
            return JSONResponse({"message": str(error)}, CONFLICT)
        except StoreError as error:
            return JSONResponse({"message": str(error)}, FAULT)
        except InputError as error:
            return JSONResponse({"message": str(error)}, BAD_REQUEST)
        except MosegError as error:
            return JSONResponse({"message": str(error)}, FAULT)
        except OSError as error:
            return JSONResponse({"message": str(error.strerror or error)}, FAULT)
        except Exception as error:
            # A fault of the program: the page has a line, and the terminal what a report of it needs.
            traceback.print_exception(error)
            return JSONResponse({"message": in_words(error)}, FAULT)

    return endpoint


async def _read_content(request: Request) -> dict[str, Any]:
    """Return the JSON object that a page sent; raises InputError if it is none, or too large."""
    if request.headers.get("content-type") != "application/json":
        raise InputError("not JSON", got=request.headers.get("content-type"), expected="application/json")
    content = bytearray()
    async for part in request.stream():
        content += part
        if len(content) > MAX_REQUEST_BYTES:
            raise InputError("a request that is too large", expected=f"at most {MAX_REQUEST_BYTES >> 20} MiB")
    try:
        value = json.loads(bytes(content))
    except (ValueError, RecursionError) as error:
        raise InputError("not JSON", got=f"{len(content)} bytes") from error
    if not isinstance(value, dict):
        raise InputError("not a JSON object", got=type(value).__name__)
    return value


def _revision(content: dict[str, Any]) -> int:
    revision = content.get("revision")
    if not isinstance(revision, int) or isinstance(revision, bool):
        raise InputError("no revision", got=repr(revision), expected="the number that the state has")
    return revision


def _read_choices(content: dict[str, Any]) -> ExportChoices:
    """Return what is to be written; raises InputError where a value is of another kind."""

    def read(name: str, kind: type, default: Any) -> Any:
        value = content.get(name, default)
        if not isinstance(value, kind) or (kind is int and isinstance(value, bool)):
            raise InputError("a value of the wrong kind", where=name, got=repr(value), expected=kind.__name__)
        return value

    names = {name: tuple(map(str, read(name, list, []))) for name in ("formats", "sets")}
    every, dilate = content.get("every"), content.get("dilate")
    return ExportChoices(
        overlay=read("overlay", str, "outline"),
        overlay_size=read("overlaySize", str, "analysed"),
        side_by_side=read("sideBySide", bool, False),
        identities=read("identities", bool, False),
        every=None if every is None else read("every", str, ""),
        dilate=None if dilate is None else read("dilate", int, 0),
        **names,
    )


def _send_labels(labels) -> Response:
    headers = {"content-encoding": "gzip"}
    return Response(pack_labels(labels), media_type="application/octet-stream", headers=headers)


def _send_picture(picture: Picture | None) -> Response:
    if picture is None:
        return Response(status_code=204)
    return Response(picture.data, media_type=picture.media_type)
