"""The base of all messages of the page."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from asterism.equilibrium.errors import Error

WholeNumber = Annotated[int, Field(ge=0, le=2**53)]


class RequestError(Error, ValueError):
    """A message that the server does not understand."""


class Request(BaseModel):
    """A message of the page.

    Attributes
    ----------
    seq : number of the message in its tab; a problem with the message carries it.
    document : number of the document that the message is about; the server refuses one about a document that is not
        open any more.
    """

    model_config = ConfigDict(extra="ignore", frozen=True, allow_inf_nan=False)
    seq: WholeNumber | None = None
    document: WholeNumber | None = None
