"""The table beside the picture."""

from PIL import Image

from moseg.workflows.api import MovingObject
from moseg.workflows.api.notebook import MAX_ROWS, draw_html

PICTURE = Image.new("RGB", (30, 20))


def test_where_nothing_moves_there_is_no_table():
    html = draw_html("still", "0 moving objects", (), PICTURE)
    assert "0 moving objects" in html and "<table" not in html


def test_of_many_objects_the_rest_is_counted():
    objects = [MovingObject(identity, 1, 0, 3, 4, 0.01) for identity in range(1, MAX_ROWS + 4)]
    html = draw_html("swarm", "many", objects, PICTURE)
    assert html.count("display:inline-block") == MAX_ROWS
    assert "and 3 more" in html


def test_each_object_bears_its_colour_and_its_score():
    objects = (
        MovingObject(1, 1, 0, 3, 4, 0.25, static_support={"trajs": 0.75, "oc": 0.125}),
        MovingObject(2, 1, 0, 3, 4, 0.25),
    )
    html = draw_html("two", "2 moving objects", objects, PICTURE)
    assert "#ff4b4b" in html and "#00ff00" in html
    assert "<td>25 %</td><td>0.88</td>" in html and "<td>25 %</td><td></td>" in html
