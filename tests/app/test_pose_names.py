"""Names of poses above their keys on the timeline."""

from unittest import mock

from risorius.app.viewer.interface import widgets
from risorius.app.viewer.timeline import key_marks
from risorius.app.viewer.timeline.keys import Track
from risorius.app.viewer.timeline.time_axis import TimeAxis


def test_a_hidden_name_leaves_its_room_to_the_name_before():
    """A name is shortened only if the next name is shown."""
    axis = TimeAxis()
    axis.place(0.0, 100.0)
    axis.span = 100.0
    names = ((0.0, "sadness"), (7.0, "contempt"), (9.5, "kiss"), (20.0, "yawn"))
    track = mock.Mock(spec=Track, names=names)
    lines = mock.Mock()
    imgui = mock.Mock()
    imgui.get_window_draw_list.return_value = lines
    imgui.calc_text_size.side_effect = lambda text: mock.Mock(x=len(text))
    with (
        mock.patch.object(key_marks, "imgui", imgui),
        mock.patch.object(widgets, "imgui", imgui),
        mock.patch.object(key_marks, "em", lambda size: size),
        mock.patch.object(key_marks, "ink_of"),
    ):
        painter = key_marks.TrackPainter(mock.Mock(), axis, mock.Mock(), 100.0)
        painter._draw_names(track, 0.0)
    assert {call.args[2] for call in lines.add_text.call_args_list} == {"sadness", "kiss", "yawn"}
