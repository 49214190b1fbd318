import { html } from '../../vendor/preact.js';
import { Gallery } from '../gallery.js';

export default function EnvironmentsPage() {
    return html`<${Gallery} kind="environment" accept=".hdr,.exr,.tif,.tiff,.pfm,.png"
        label="Drop HDR environments here, or pick them: HDR, EXR, TIFF, PFM or PNG, lat-long or a cube in one picture"
        empty="No environment is stored yet." />`;
}
