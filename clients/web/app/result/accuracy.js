// The errors of a bake's results, as its manifest states them.
import { count_text, number_text } from '../number_text.js';

const digits = 3;

const interval = ([low, high]) => `${number_text(low, digits)} to ${number_text(high, digits)}`;
const with_interval = (value, range) => `${number_text(value, digits)} (95 %: ${interval(range)})`;
const of_largest = share => `${number_text(100 * share, digits)} % of the largest value`;

/** A against traced strands; nothing for a bake without hair or without reference vertices. */
function transmittance_rows(bar) {
    if (!bar) return [];
    if (bar.vertices === 0)
        return [['A against traced strands', 'not measured: every vertex drawn lies inside another strand']];
    return [
        ['A against traced strands, RMSE', with_interval(bar.rmse, bar.ci95.rmse)],
        ['Bias', with_interval(bar.bias, bar.ci95.bias)],
        ...(bar.noise === undefined ? [] : [['Noise of the reference, taken off', number_text(bar.noise, digits)]]),
        [
            'Measured with',
            `${count_text(bar.vertices, 'vertex', 'vertices')}, ${count_text(bar.directions, 'direction')} each`,
        ],
    ];
}

/** Errors relative to the largest value of the maps of the same kind; sh_bands and predicted_error exist for the method sh alone. */
function irradiance_rows({ interpolation_bound_relative, sh_bands, predicted_error }) {
    const rows = [];
    if (interpolation_bound_relative !== undefined)
        rows.push(['Between specular maps, at most', of_largest(interpolation_bound_relative)]);
    if (sh_bands) rows.push(['SH bands', `diffuse ${sh_bands.diffuse}, specular ${sh_bands.specular}`]);
    if (predicted_error)
        rows.push(
            ['Predicted SH error of the diffuse map, RMS', of_largest(predicted_error.diffuse)],
            ['Predicted SH error of the specular maps, RMS', of_largest(predicted_error.specular)],
        );
    return rows;
}

/** [term, text] of every error in a manifest. */
export const accuracy_rows = manifest => [
    ...transmittance_rows(manifest.error_bar),
    ...irradiance_rows(manifest.irradiance ?? {}),
];
