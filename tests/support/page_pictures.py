# SPDX-License-Identifier: Apache-2.0
"""Scripts for a page of standoff view, as text: its picture as a data URL, and how pictures differ."""


def picture_of(viewer_share):
    """What is seen without what lies over it, at a share of the canvas's size, on the page's ground."""
    return f"""(() => {{
  viewer.renderer.showAgain();
  const canvas = document.createElement('canvas'), context = canvas.getContext('2d');
  [canvas.width, canvas.height] = [viewer.canvas.width * {viewer_share}, viewer.canvas.height * {viewer_share}];
  context.fillStyle = getComputedStyle(document.documentElement).getPropertyValue('--ground');
  context.fillRect(0, 0, canvas.width, canvas.height);
  context.imageSmoothingQuality = 'high';
  context.drawImage(viewer.canvas, 0, 0, canvas.width, canvas.height);
  return canvas.toDataURL();
}})()"""


DRAWN, WHOLE = picture_of("1 / 6"), picture_of(1)

_BYTES = """const bytesOf = async url => {
    const image = new Image();
    image.src = url;
    await image.decode();
    const canvas = document.createElement('canvas'), context = canvas.getContext('2d');
    [canvas.width, canvas.height] = [image.width, image.height];
    context.drawImage(image, 0, 0);
    return context.getImageData(0, 0, image.width, image.height).data;
  };"""

# How many colors a picture has.
COLORS = f"""async url => {{
  {_BYTES}
  return new Set(new Uint32Array((await bytesOf(url)).buffer)).size;
}}"""

# The mean difference of two pictures' bytes; 255 where their sizes differ.
COMPARE = f"""async (...urls) => {{
  {_BYTES}
  const [a, b] = await Promise.all(urls.map(bytesOf));
  return a.length !== b.length ? 255 : a.reduce((sum, v, n) => sum + Math.abs(v - b[n]), 0) / a.length;
}}"""
