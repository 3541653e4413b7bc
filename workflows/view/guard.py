"""Guard of the server: only pages that it gave out itself, on this machine, may ask it anything."""

import secrets
from collections.abc import Mapping

from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

POLICY = "; ".join(
    (
        "default-src 'none'",
        "script-src 'self'",
        "style-src 'self'",
        "img-src 'self' blob: data:",
        "connect-src 'self'",
        "base-uri 'none'",
        "form-action 'none'",
        "frame-ancestors 'none'",
        "require-trusted-types-for 'script'",
        "trusted-types 'none'",
    )
)
HEADERS = {
    "content-security-policy": POLICY,
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
    "permissions-policy": "camera=(), microphone=(), geolocation=()",
}
"""Of each response. The address contains the token, so that it is handed to nobody."""
_READING = ("GET", "HEAD")
_OWN_SITES = ("same-origin", "none")
"""``Sec-Fetch-Site`` of the page's own requests, and of an address that the user opens."""


class Guard:
    """A filter of requests in front of an application.

    The token is the first part of every address, and not a cookie: browsers send a cookie to all ports of a host, so
    that other servers of this machine would get it. The name of the host is compared, because a page of another name
    could have its name resolved to this machine; the origin, because any page may send requests here.

    Parameters
    ----------
    app : ASGI application
        It sees addresses without the token.
    token : str
    port : int
    """

    def __init__(self, app: ASGIApp, token: str, port: int):
        self._app = app
        self._token = token.encode("ascii")
        self._hosts = (f"127.0.0.1:{port}", f"localhost:{port}")

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on, or refuse it with status 403."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        if scope["type"] != "http":
            # A socket is not opened.
            await send({"type": "websocket.close", "code": 1008})
            return

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                given = {name.lower() for name, _ in message["headers"]}
                more = [(name.encode(), value.encode()) for name, value in HEADERS.items()]
                more.append((b"cache-control", b"no-store"))
                message["headers"] = [*message["headers"], *(entry for entry in more if entry[0] not in given)]
            await send(message)

        headers = {name.decode("latin-1"): value.decode("latin-1") for name, value in scope["headers"]}
        refusal = self._find_fault(scope["method"], headers)
        first, slash, rest = scope["path"].removeprefix("/").partition("/")
        if refusal is None and not secrets.compare_digest(first.encode("utf-8", "replace"), self._token):
            refusal = "this address lacks the session's token: open the one that `moseg view` printed"
        if refusal is not None:
            await PlainTextResponse(f"moseg view: {refusal}\n", 403)(scope, receive, send_with_headers)
            return
        inner = {**scope, "path": slash + rest or "/", "raw_path": None, "root_path": ""}
        await self._app(inner, receive, send_with_headers)

    def _find_fault(self, method: str, headers: Mapping[str, str]) -> str | None:
        """Return what is wrong with the origin of a request; None if nothing is."""
        host = headers.get("host", "")
        if host not in self._hosts:
            return "not the name of this server"
        origin = headers.get("origin")
        if origin != f"http://{host}" and (origin is not None or method not in _READING):
            return "a request from another origin"
        if headers.get("sec-fetch-site", "none") not in _OWN_SITES:
            return "a request from another site"
        return None
