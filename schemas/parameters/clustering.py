"""Parameters of the fusion of views, of the grouping of objects and of the number of motions."""

from typing import Annotated, Literal

from pydantic import Field

from schemas.frozen import Frozen


class ClusteringParams(Frozen):
    """How affinities of several views become motion groups."""

    motions: Literal["gt", "auto"] | Annotated[int, Field(ge=1)] = Field(
        "auto", description="number of motions with the background: gt, auto or N"
    )
    fusion: Literal["product", "sum", "coregularised"] = Field(
        "product",
        description="one kernel, the views' geometric or arithmetic mean, or co-regularised embeddings (the paper)",
    )
    grouping: Literal["linkage", "spectral"] = Field(
        "linkage", description="average linkage around the background, or k-means on the spectral embedding (the paper)"
    )
    auto: Literal["threshold", "eigengap"] = Field(
        "threshold", description="how the number of motions is found where it is not given"
    )
    threshold: float = Field(
        0.5,
        gt=0,
        lt=1,
        description="least affinity at which two groups are one motion (threshold), and least support for static in"
        " every view at which an object is dropped (agreement)",
    )
    static: Literal["auto", "agreement", "group"] = Field(
        "auto",
        description="what is static where the number of motions is found: objects of which every view says so, or that"
        " none knows (agreement), the background's group (group), or (auto) the first for proposals cut out because"
        " they move (saliency) and the second for all others",
    )
    co_regularisation: float = Field(0.1, ge=0, description="lambda of Kumar et al. 2011")
    num_iterations: int = Field(20, ge=1, description="most alternating updates of all views")
    tolerance: float = Field(1e-9, ge=0, description="relative growth of the objective at which the updates stop")
