"""Parameters of co-regularised multi-view spectral clustering and of the number of motions."""

from typing import Literal

from pydantic import Field

from schemas.frozen import Frozen


class ClusteringParams(Frozen):
    """How affinities of several views become motion groups."""

    motions: Literal["gt", "auto"] | int = Field("auto", description="number of motions with the background: gt, auto or N")
    co_regularisation: float = Field(0.1, ge=0, description="lambda of Kumar et al. 2011")
