"""The refusals that only HTTP knows. The tree of all other errors is in ``schemas.errors``.

    FootfallError
    +-- NoRoute             nothing is served at this path
    +-- WrongMethod         something is, but not by this method
    +-- NotAcceptable       the answer exists in none of the accepted types
    +-- SlowBody            the body did not arrive in time
    +-- UnsupportedMedia    the body is not JSON in UTF-8
    +-- BadParameter        a query parameter, header or small body is malformed
    +-- KeyReused           an idempotency key came again with another body
    +-- WrongHost           the request names a host that this service is not
    +-- NotReady            the service cannot take work now
    +-- Bug                 an error nobody foresaw
    +-- OtherRefusal        the framework refused, for a reason of its own

``TYPES`` is the whole table, of these and the shared ones.
"""

from schemas.errors import PROBLEM_TYPES, FootfallError, ProblemType


class NoRoute(FootfallError):
    """Nothing is served at this path. ``GET /openapi.json`` lists what is."""


class WrongMethod(FootfallError):
    """The path is known, but not with this method. The ``Allow`` header lists the known ones."""


class NotAcceptable(FootfallError):
    """The answer exists in none of the media types that the ``Accept`` header allows."""


class SlowBody(FootfallError):
    """The request's body did not arrive in time."""


class UnsupportedMedia(FootfallError):
    """The body is not declared as ``application/json`` in UTF-8 without compression."""


class BadParameter(FootfallError):
    """A query parameter, a header or a small body is malformed."""

    def __init__(self, message: str, hint: str = "", parameter: str = "") -> None:
        super().__init__(message, hint)
        self.parameter = parameter


class KeyReused(FootfallError):
    """An idempotency key stands for one request; it came again with another body."""


class WrongHost(FootfallError):
    """The ``Host`` header names another host. Without keys only loopback names are served."""


class NotReady(FootfallError):
    """The service is up but cannot take work: its queue server or every worker is away."""


class Bug(FootfallError):
    """The service met an error that nobody foresaw; its log has the story under the given id."""


class OtherRefusal(FootfallError):
    """The web framework refused the request for a reason of its own."""


TYPES: dict[type[FootfallError], ProblemType] = {
    **PROBLEM_TYPES,
    NoRoute: ProblemType("no-route", 404, "There is nothing at this path"),
    WrongMethod: ProblemType("wrong-method", 405, "The method is not known here"),
    NotAcceptable: ProblemType("not-acceptable", 406, "No accepted media type fits"),
    SlowBody: ProblemType("slow-body", 408, "The body came too slowly"),
    UnsupportedMedia: ProblemType("unsupported-media", 415, "The body must be JSON"),
    BadParameter: ProblemType("bad-parameter", 422, "A parameter is malformed"),
    KeyReused: ProblemType("key-reused", 422, "The idempotency key has another body"),
    WrongHost: ProblemType("wrong-host", 421, "This service has another name"),
    NotReady: ProblemType("not-ready", 503, "The service is not ready", 5),
    Bug: ProblemType("internal-error", 500, "The service met a bug"),
    OtherRefusal: ProblemType("refused", 400, "The request was refused"),
}
