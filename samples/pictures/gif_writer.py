"""Writes pictures as an animated GIF of few bytes: one palette for all frames, and only the pixels that change."""
import numpy as np
from PIL import Image

BITS = 6  # of each channel, by which colours are counted and looked up
LEVELS, STEP = 1 << BITS, 256 >> BITS
HELD_BACK = 10  # a pixel is drawn again only if a channel is farther than this from what is shown: soft shadows always move
SAMPLED_FRAMES = 10


def cells_of(pixels):
    """The number of each pixel's cell in a cube of colours."""
    red, green, blue = np.moveaxis(pixels.astype(int) // STEP, -1, 0)
    return (red * LEVELS + green) * LEVELS + blue


def colours_of(cells):
    """The colours in the middle of cells."""
    return np.stack(np.unravel_index(cells, (LEVELS,) * 3), -1) * STEP + STEP // 2


def find_palette(frames, count, fixed):
    """At most `count` colours, those of `fixed` at the end. A colour counts by the square root of its area in the sampled
    frames: by the area itself, the backdrop would take nearly all."""
    areas = sum(np.bincount(cells_of(np.asarray(frame)).ravel(), minlength=LEVELS ** 3)
                for frame in frames[::-(-len(frames) // SAMPLED_FRAMES)])
    listed = colours_of(np.repeat(np.arange(LEVELS ** 3), np.round(np.sqrt(areas)).astype(int)))
    reduced = Image.fromarray(listed[None].astype(np.uint8), "RGB").quantize(count - len(fixed), kmeans=3)
    found = np.array(reduced.getpalette()).reshape(-1, 3)[:len(reduced.getcolors())]
    return np.concatenate([found, fixed])


def nearest_colours(palette):
    """For each cell the number of the nearest colour of the palette."""
    colours = colours_of(np.arange(LEVELS ** 3)).astype(np.float32)
    distances = (palette ** 2).sum(axis=1) - 2 * colours @ palette.T.astype(np.float32)  # squared, less what all share
    nearest = distances.argmin(axis=1)
    nearest[cells_of(palette)] = np.arange(len(palette))  # the last ones, which are fixed, stay exact
    return nearest


def changes(frames, palette):
    """Each frame as numbers of colours; a pixel that stays as it is has the number behind the palette's last one."""
    nearest, shown = nearest_colours(palette), None
    for frame in frames:
        pixels = np.asarray(frame).astype(int)
        wanted = drawn = nearest[cells_of(pixels)]
        if shown is not None:
            stays = (np.abs(pixels - palette[shown]).max(axis=2) <= HELD_BACK) | (wanted == shown)
            wanted, drawn = np.where(stays, shown, wanted), np.where(stays, len(palette), wanted)
        shown = wanted
        yield drawn.astype(np.uint8)


def write_gif(frames, path, milliseconds, colours, fixed):
    """`fixed`: colours that the palette must have, such as that of the page."""
    palette = find_palette(frames, colours, fixed)
    pictures = [Image.fromarray(numbers, "P") for numbers in changes(frames, palette)]
    for picture in pictures:
        picture.putpalette(palette.astype(np.uint8).tobytes())
    pictures[0].save(path, format="GIF", save_all=True, append_images=pictures[1:], duration=milliseconds, loop=0,
                     disposal=1, transparency=len(palette), optimize=False)
