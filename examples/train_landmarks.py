"""Train a network for landmarks on a data set, and test it on photographs.

    pip install '.[torch,dlib]'
    risorius dataset --count 2000 --seed 2026 --size 160x160 --background pictures -o faces
    python examples/train_landmarks.py faces photographs

An error is the mean distance in hundredths of the distance between the outer corners of the eyes.
As in tests on 300-W, faces are cut out by their known points; see `landmark_faces.py`.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
import torch
from landmark_faces import (
    PICTURE_SIDE,
    STORED_SIDE,
    Face,
    points_of_dlib,
    read_photographs,
    read_set,
)
from torch import Tensor, nn
from torch.nn import functional

from risorius.bench.landmarks import LANDMARK_GROUPS
from risorius.faces import Faces
from risorius.sim.landmarks import MIRRORED_LANDMARKS

MIRRORED_POINTS = torch.from_numpy(
    MIRRORED_LANDMARKS
)  # the number of each point in a mirrored picture


def tensors(faces: list[Face]) -> tuple[Tensor, Tensor]:
    """Pictures (n, 3, 144, 144) 0..255 and points (n, 68, 2)."""
    pictures = np.stack([picture for picture, _ in faces])
    points = np.stack([points for _, points in faces])
    return torch.from_numpy(pictures), torch.from_numpy(points)


def seen(pictures: Tensor, points: Tensor, changes: Tensor | None = None) -> tuple[Tensor, Tensor]:
    """Pictures and points for the network: the middle of each picture, or its part in `changes`.

    changes: an affine map from the result to the picture, for each picture, shape (n, 2, 3).
    """
    middle = torch.tensor(
        [[PICTURE_SIDE / STORED_SIDE, 0.0, 0.0], [0.0, PICTURE_SIDE / STORED_SIDE, 0.0]]
    )
    view = middle.expand(len(pictures), 2, 3) if changes is None else changes
    grid = functional.affine_grid(
        view, [len(pictures), 3, PICTURE_SIDE, PICTURE_SIDE], align_corners=False
    )
    bright = pictures.float() / 255.0
    inside = functional.grid_sample(bright, grid, padding_mode="reflection", align_corners=False)
    turn = view[:, :, :2]
    shift = view[:, None, :, 2]
    places = (points - shift) @ torch.linalg.inv(turn).transpose(1, 2)
    return inside, places


def varied(pictures: Tensor, points: Tensor) -> tuple[Tensor, Tensor]:
    """Pictures and points for training: turned, moved, mirrored, with other colours and quality."""
    inside, places = _turned(pictures, points)
    inside = _recoloured(inside)
    _blur(inside)
    inside += torch.randn_like(inside) * torch.rand(len(inside), 1, 1, 1) * 0.06
    _cover(inside)
    return inside, places


def _turned(pictures: Tensor, points: Tensor) -> tuple[Tensor, Tensor]:
    """Turn, scale, stretch, shift and mirror at random."""
    count = len(pictures)
    angle = torch.randn(count) * 0.35  # radians
    size = PICTURE_SIDE / STORED_SIDE * torch.exp(torch.randn(count) * 0.15)
    stretch = torch.exp(torch.randn(count) * 0.06)
    is_mirrored = torch.rand(count) < 0.5
    width = torch.where(is_mirrored, -stretch, stretch)
    shift_across = torch.randn(count) * 0.08
    shift_down = torch.randn(count) * 0.08
    across = torch.stack([angle.cos() * width, -angle.sin(), shift_across], dim=1)
    down = torch.stack([angle.sin() * width, angle.cos(), shift_down], dim=1)
    changes = torch.stack([across, down], dim=1)
    changes[:, :, :2] *= size[:, None, None]
    inside, places = seen(pictures, points, changes)
    places[is_mirrored] = places[is_mirrored][:, MIRRORED_POINTS]
    return inside, places


def _recoloured(pictures: Tensor) -> Tensor:
    """Change saturation, the colour of the light, exposure and contrast at random."""
    count = len(pictures)
    grey = pictures.mean(dim=1, keepdim=True)
    saturation = torch.rand(count, 1, 1, 1) * 1.3
    light = torch.randn(count, 3, 1, 1) * 0.12
    exposure = torch.randn(count, 1, 1, 1) * 0.2
    contrast = torch.exp(torch.randn(count, 1, 1, 1) * 0.25)
    saturated = torch.lerp(grey, pictures, saturation)
    lit = saturated * torch.exp(light + exposure)
    return lit.clamp(1e-4, 1.0) ** contrast


def _random_part(pictures: Tensor) -> list[int]:
    """Indices of about four tenths of the pictures, chosen at random."""
    is_taken = torch.rand(len(pictures)) < 0.4
    numbers: list[int] = torch.nonzero(is_taken).flatten().tolist()
    return numbers


def _blur(pictures: Tensor) -> None:
    """Blur some pictures by reducing and enlarging them."""
    for number in _random_part(pictures):
        small = int(torch.randint(28, 80, ()))
        picture = pictures[number : number + 1]
        soft = functional.interpolate(picture, (small, small), mode="area")
        pictures[number] = functional.interpolate(
            soft, (PICTURE_SIDE, PICTURE_SIDE), mode="bilinear"
        )[0]


def _cover(pictures: Tensor) -> None:
    """Cover some faces by a rectangle of one colour."""
    for number in _random_part(pictures):
        top, left, height, width = torch.randint(8, 72, (4,)).tolist()
        rows = slice(top, top + height // 2)
        columns = slice(left, left + width // 2)
        pictures[number, :, rows, columns] = torch.rand(3, 1, 1)


def block(before: int, after: int, stride: int = 1) -> nn.Sequential:
    """A convolution with batch normalisation and ReLU."""
    convolution = nn.Conv2d(before, after, 3, stride, padding=1, bias=False)
    return nn.Sequential(convolution, nn.BatchNorm2d(after), nn.ReLU(inplace=True))


class Network(nn.Module):
    """Predicts points as means of 24 x 24 heat maps (Sun et al. 2018, "Integral human pose
    regression").
    """

    def __init__(self) -> None:
        super().__init__()
        self.fine = nn.Sequential(block(3, 16, 2), block(16, 32, 2))
        self.middle = nn.Sequential(block(32, 64, 2), block(64, 64))
        self.coarse = nn.Sequential(block(64, 128, 2), block(128, 64))
        self.down = block(64, 32)
        self.maps = nn.Sequential(block(32, 48), nn.Conv2d(48, 68, 1))

    def forward(self, pictures: Tensor) -> Tensor:
        """Points (n, 68, 2) in pictures (n, 3, 96, 96)."""
        fine = self.fine(pictures - 0.5)
        middle = self.middle(fine)
        middle = middle + functional.interpolate(self.coarse(middle), scale_factor=2)
        maps = self.maps(fine + functional.interpolate(self.down(middle), scale_factor=2))
        weights = maps.flatten(2).softmax(dim=2).view_as(maps)
        places = (2.0 * torch.arange(24) + 1.0) / 24.0 - 1.0
        return torch.stack([weights.sum(2) @ places, weights.sum(3) @ places], dim=2)


def train(faces: list[Face], epochs: int, is_plain: bool) -> Network:
    """Train a network on faces. is_plain: train without random variations of the faces."""
    pictures, points = tensors(faces)
    network = Network().to(memory_format=torch.channels_last)  # faster on a processor
    steps = (len(faces) + 31) // 32
    optimiser = torch.optim.AdamW(network.parameters(), weight_decay=1e-3)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimiser, 4e-3, epochs * steps)
    for epoch in range(epochs):
        total = 0.0
        for chosen in torch.randperm(len(faces)).chunk(steps):
            batch = pictures[chosen], points[chosen]
            inside, places = seen(*batch) if is_plain else varied(*batch)
            loss = (network(inside) - places).abs().mean()
            optimiser.zero_grad()
            loss.backward()
            optimiser.step()
            schedule.step()
            total += loss.item()
        print(f"epoch {epoch + 1}: {total / steps:.4f}", flush=True)
    return network.eval()


def predicted(network: Network, pictures: Tensor) -> Tensor:
    """Points (n, 68, 2) in pictures: the mean of those in the picture and in its mirror image."""
    with torch.no_grad():
        direct = network(pictures)
        mirrored = network(pictures.flip(3))[:, MIRRORED_POINTS]
    return 0.5 * (direct + mirrored * torch.tensor([-1.0, 1.0]))


def percent(found: Tensor, places: Tensor) -> Tensor:
    """Errors (n, 68) of points (n, 68, 2), in percent of the distance between the eyes."""
    apart = (places[:, 36] - places[:, 45]).norm(dim=1, keepdim=True)
    return 100.0 * (found - places).norm(dim=2) / apart


def report(name: str, faces: list[Face], network: Network, mean: Tensor) -> None:
    """Print the errors on some faces: of the mean face, of the network, of dlib."""
    if not faces:
        return
    pictures, points = tensors(faces)
    inside, places = seen(pictures, points)
    rows = {"mean face": mean.expand_as(places), "network": predicted(network, inside)}
    rows["dlib"] = torch.from_numpy(points_of_dlib(faces) * STORED_SIDE / PICTURE_SIDE).float()
    print(
        f"{name}, {len(faces)} faces [%]".ljust(44), *(f"{group:>7}" for group in LANDMARK_GROUPS)
    )
    for reader, places_found in rows.items():
        errors = percent(places_found, places)
        errors = errors[~errors[:, 0].isnan()]
        means = [f"{errors[:, numbers].mean():7.2f}" for numbers in LANDMARK_GROUPS.values()]
        print(f"    {reader} ({len(errors)} faces)".ljust(44), *means)


def main() -> None:
    """Train, test, print."""
    command = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    command.add_argument("set", type=Path, help="the folder of a set")
    command.add_argument("photographs", type=Path, nargs="?", help="a folder of pictures")
    command.add_argument("--epochs", type=int, default=24)
    command.add_argument("--plain", action="store_true", help="do not vary the pictures")
    command.add_argument("--jaw-on-bone", action="store_true", help="use the rig's jaw landmarks")
    given = command.parse_args()
    torch.manual_seed(1)
    faces = Faces(given.set)
    training, testing = faces.split(share=0.1)
    learned = read_set(faces, training, given.jaw_on_bone)
    network = train(learned, given.epochs, given.plain)
    mean = seen(*tensors(learned))[1].mean(dim=0)
    report("ours", read_set(faces, testing, given.jaw_on_bone), network, mean)
    if given.photographs:
        by_hand, by_dlib = read_photographs(given.photographs)
        report("photographs marked by hand", by_hand, network, mean)
        report("photographs read by dlib", by_dlib, network, mean)


if __name__ == "__main__":
    main()
