import numpy as np
import pytest
from helpers import rough_road
from matplotlib.animation import AbstractMovieWriter
from PIL import Image

import bridgectl as bc
from bridgectl import crossing_animation
from bridgectl.dampers import skyhook

SPEED = 25.0


class Watcher(AbstractMovieWriter):
    """Looks at every frame in place of writing it."""

    def __init__(self, see):
        super().__init__(fps=10)
        self.see, self.seen = see, []

    def setup(self, fig, outfile, dpi=None):
        super().setup(fig, outfile, dpi=dpi)
        self.parts = {
            part.get_label(): part
            for axes in fig.axes
            for part in [*axes.lines, *axes.patches]
            if not part.get_label().startswith("_")
        }

    def grab_frame(self, **_):
        self.seen.append(self.see(self.parts, self.fig))

    def finish(self):
        pass


def watch(animation, see):
    watcher = Watcher(see)
    animation.save("nothing", writer=watcher)
    return watcher.seen


def words(figure):
    return " ".join(text.get_text() for axes in figure.axes for text in axes.texts)


@pytest.fixture(scope="module")
def road():
    return rough_road(3, -20, 25)


def test_the_vehicle_is_at_ct_in_every_frame(bridge, truck, road):
    animation = crossing_animation(bridge, truck, SPEED, road, start=-20, frames=5)

    def places(parts, _):
        x = parts["tire"].get_center()[0]
        body = parts["body"].get_x() + parts["body"].get_width() / 2
        assert parts["hub"].get_xdata() == pytest.approx([x])
        assert body == pytest.approx(x)
        assert parts["moment"].get_xdata()[-1] == pytest.approx(x)
        return x

    x = watch(animation, places)
    assert x == pytest.approx(np.linspace(-0.16 * 25, 1.12 * 25, 5))


def test_the_deflection_drawn_is_that_of_the_response_times_the_factor_told(bridge, truck):
    frames = 9

    def middle(parts, figure):
        line = parts["road"]  # a smooth road lies on the bridge as it bends
        factor = float(words(figure).split("deflection of the bridge ")[1].split()[0])
        return np.interp(12.5, line.get_xdata(), line.get_ydata()) / factor

    drawn = watch(crossing_animation(bridge, truck, SPEED, frames=frames), middle)
    times = np.linspace(0, 1.12 * 25, frames) / SPEED
    response = bc.crossing_response(bridge, truck, SPEED, timepts=times, tail=0.13 * 25 / SPEED)
    assert -np.array(drawn) == pytest.approx(response.outputs[1], abs=1e-12)
    assert np.abs(drawn).max() > 4e-4  # about the static deflection, 0.66 mm


@pytest.mark.slow
def test_the_curves_are_moment_and_tire_force_of_the_response(bridge, truck, road):
    law = skyhook(1e3, 30e3)
    animation = crossing_animation(
        bridge, truck, SPEED, road, damper=law, start=-20, frames=4, fps=5
    )
    curves = watch(
        animation, lambda parts, _: [parts[n].get_data() for n in ("moment", "tire force")]
    )
    (x, moment), (_, force) = curves[-1]
    assert len(curves[0][0][0]) == 1  # they build up from the first frame on
    response = bc.crossing_response(
        bridge, truck, SPEED, road, damper=law, start=-20, tail=0.13 * 25 / SPEED, timepts=x / SPEED
    )
    labels = response.output_labels
    assert moment == pytest.approx(response.outputs[labels.index("moment")])
    assert force * 98100 == pytest.approx(response.outputs[labels.index("tire_force")])


def test_the_tire_stands_on_the_road_where_it_carries_its_static_load(bridge, truck):
    def gap(parts, _):
        x, hub = parts["tire"].get_center()
        on = np.interp(x, *parts["road"].get_data())
        return hub - parts["tire"].get_radius() - on

    level = bc.RoadProfile([-20, 25], [0, 0])
    gaps = watch(crossing_animation(bridge, truck, SPEED, level, start=-20, frames=3), gap)
    assert gaps[0] == pytest.approx(0, abs=1e-9)


def test_it_saves_a_small_gif_of_its_frames(bridge, truck, road, tmp_path):
    animation = crossing_animation(bridge, truck, SPEED, road, start=-20, frames=4, fps=10)
    path = tmp_path / "crossing.gif"
    animation.save(path, writer="pillow", dpi=40)
    assert path.stat().st_size < 60_000
    with Image.open(path) as image:
        assert image.n_frames == 4
        assert image.info["duration"] == 100


def test_every_axis_is_labelled_with_its_unit_and_the_title_tells_how_slow_it_is(bridge, truck):
    seen = watch(
        crossing_animation(bridge, truck, SPEED, frames=5, fps=1),
        lambda _, figure: (
            figure.axes[0].get_title(loc="left"),
            [axes.get_ylabel() for axes in figure.axes[1:]],
            figure.axes[-1].get_xlabel(),
        ),
    )
    title, heights, length = seen[0]
    # 28 m at 25 m/s are 1.12 s; 5 frames take 5 s.
    assert title == "90 km/h over a bridge of 25 m, 4.5 times slower than it is"
    assert all(label.endswith("[-]") for label in heights)
    assert length == "tire at x from the start of the bridge [m]"


@pytest.mark.parametrize(
    ("wrong", "error", "message"),
    [
        ({"frames": 1}, ValueError, "frames must be 2 or more, got 1"),
        ({"frames": 2.5}, TypeError, "frames must be a whole number, got 2.5"),
        ({"fps": 0}, ValueError, "fps must be above 0, got 0"),
        ({"speed": -3.0}, ValueError, r"speed must be above 0 \[m/s\], got -3"),
        ({"start": 5.0}, ValueError, "start must be 0 m"),
        ({"profile": [0.0, 1.0]}, TypeError, "profile must be a bridgectl.RoadProfile, got list"),
        ({"start": -50.0, "profile": rough_road(1, 0, 25)}, ValueError, "road"),
    ],
)
def test_bad_input_is_one_clear_error(bridge, truck, wrong, error, message):
    arguments = {"speed": SPEED, "profile": None, **wrong}
    with pytest.raises(error, match=message):
        crossing_animation(bridge, truck, **arguments)


def line_of(body):
    """Ends of the lower edge of a body as it is drawn."""
    left, width = body.get_x(), body.get_width()
    along = body.get_transform() - body.axes.transData
    return along.transform([(left, body.get_y()), (left + width, body.get_y())])


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:start = -20 m:UserWarning")  # a short approach will do
@pytest.mark.parametrize("name", ["T5", "T5tridem"])
def test_the_bodies_of_a_truck_roll_over_the_road_joined_at_the_hinge(bridge, road, name):
    truck = bc.trucks.load(name)
    animation = crossing_animation(bridge, truck, SPEED, road, start=-20, frames=4)

    def look(parts, _):
        tires = [parts["tire"], *(parts[f"tire {i}"] for i in range(2, truck.n_tires + 1))]
        x = np.array([tire.get_center()[0] for tire in tires])
        assert x[0] - x == pytest.approx(truck.tire_offsets)
        ends = line_of(parts["body"]), line_of(parts["body 2"])
        # Rear and front of each: x grows forward, as the vehicle drives.
        for (rear, front), told in zip(ends, truck.body_places, strict=True):
            assert (x[0] - front[0], x[0] - rear[0]) == pytest.approx(tuple(told))
        (hinge_x,), (hinge,) = parts["hinge"].get_data()
        assert ends[1][1] == pytest.approx([hinge_x, hinge])
        (rear, front), tall = ends[0], parts["body"].get_height()
        assert hinge == pytest.approx(np.interp(hinge_x, *np.array([rear, front]).T) + tall)
        return x[0], [front[1] - rear[1] for rear, front in ends]

    seen = watch(animation, look)
    # Until the last axle is a little behind the bridge.
    assert seen[-1][0] == pytest.approx(1.12 * 25 + truck.tire_offsets[-1])
    assert np.ptp([pitch for _, pitches in seen for pitch in pitches]) > 0.1  # m as drawn


@pytest.mark.filterwarnings("ignore:start = -20 m:UserWarning")
def test_the_springs_of_a_truck_end_at_axle_and_body(bridge, road):
    animation = crossing_animation(bridge, bc.trucks.load("T2"), SPEED, road, start=-20, frames=3)

    def look(parts, _):
        rear, front = line_of(parts["body"])
        for spring, hub in (("spring", "hub"), ("spring 2", "hub 2")):
            x, heights = parts[spring].get_data()
            assert heights[0] == pytest.approx(parts[hub].get_ydata()[0])
            assert heights[-1] == pytest.approx(np.interp(x[-1], *np.array([rear, front]).T))

    watch(animation, look)


def test_what_tells_no_bodies_has_a_box_at_each_tire_and_every_tire_its_curve(bridge, truck):
    mass = bc.Vehicle([[5750.0]], [[0.0]], [[0.0]], [1.595e6])  # sprung mass: no leg
    convoy = bc.convoy([truck, mass, bc.trucks.load("T2")], [0, 5, 12])
    animation = crossing_animation(bridge, convoy, SPEED, frames=3)

    def look(parts, _):
        middles = [
            parts[name].get_x() + parts[name].get_width() / 2
            for name in ("body", "body 2", "body 3")
        ]
        x = parts["tire"].get_center()[0]
        assert sorted(x - np.array(middles)) == pytest.approx([0, 5, 14.5])
        return [parts[name].get_ydata()[-1] for name in ("tire force", "tire force 4")]

    forces = watch(animation, look)[-1]
    x = np.array([1.0, 1.12 * 25 + 17]) / SPEED
    response = bc.crossing_response(bridge, convoy, SPEED, tail=0.13 * 25 / SPEED, timepts=x)
    loads = convoy.static_loads
    for force, tire in zip(forces, (0, 3), strict=True):
        found = response.outputs[f"tire_force_{tire + 1}"]
        assert force * loads[tire] == pytest.approx(found[-1], rel=1e-6)


@pytest.mark.slow
def test_several_spans_are_drawn_with_their_supports_and_a_moment_over_the_pier(truck):
    bridge = bc.Bridge([20, 30], 18358, 4.865e10)
    pier = bc.Moment(20.0, sense="smallest")
    animation = crossing_animation(bridge, truck, SPEED, effect=pier, frames=41)

    def look(parts, figure):
        scene = figure.axes[0]
        marks = [line.get_xdata()[0] for line in scene.lines if line.get_ls() == "None"]
        static = parts["static"].get_ydata()
        return (
            scene.get_title(loc="left"),
            marks[:3],
            static.max(),
            parts["moment"].get_ydata().max(),
        )

    title, marks, static, moment = watch(animation, look)[-1]
    assert "a bridge of 20 + 30 m" in title
    assert marks == [0, 20, 50]
    assert static == pytest.approx(1, abs=0.01)  # of some points
    assert moment == pytest.approx(bc.daf(bridge, truck, SPEED, effect=pier)[0], abs=0.005)


@pytest.mark.parametrize(
    ("effect", "message"),
    [(bc.Deflection(), "effect must be a Moment"), (None, "must have a static peak")],
)
def test_what_has_no_moment_to_draw_is_told(truck, effect, message):
    with pytest.raises((TypeError, ValueError), match=message):
        crossing_animation(bc.Bridge([25, 25], 18358, 4.865e10), truck, SPEED, effect=effect)
