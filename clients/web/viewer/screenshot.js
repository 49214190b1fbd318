// The picture of the viewer as a file.

/** Downloads the picture as a PNG named after the bake. view: HairView of `canvas`. */
export async function save_screenshot(view, canvas, id) {
    const picture = await view.screenshot(getComputedStyle(canvas).backgroundColor);
    const link = document.createElement('a');
    link.href = URL.createObjectURL(picture);
    link.download = `hairbake_${id.slice(0, 12)}.png`;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}
