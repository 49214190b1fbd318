// A camera that orbits a target: core/render/camera.h in JavaScript, with the moves of a user.

const add = (a, b, factor = 1) => a.map((x, i) => x + factor * b[i]);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

/** Azimuth 0 looks from +Z, 90 from +X; elevation 90 looks down from +Y. Lengths in the model's unit. */
export class OrbitCamera {
    azimuth_deg = 0;
    elevation_deg = 0;
    fov_deg = 30; // vertical
    distance = 1;
    target = [0, 0, 0];

    /** Unit axes, right-handed; `backward` points from the scene to the eye. */
    axes() {
        const azimuth = (this.azimuth_deg * Math.PI) / 180,
            elevation = (this.elevation_deg * Math.PI) / 180;
        const right = [Math.cos(azimuth), 0, -Math.sin(azimuth)];
        const level = Math.cos(elevation);
        const backward = [level * Math.sin(azimuth), Math.sin(elevation), level * Math.cos(azimuth)];
        return { right, up: cross(backward, right), backward };
    }

    eye() {
        return add(this.target, this.axes().backward, this.distance);
    }

    /** Sets the distance so that the box [[low], [high]] fills the picture up to a small margin. The angles stay. */
    frame([low, high], aspect) {
        const { right, up, backward } = this.axes(),
            tangent = this.tangent();
        this.target = add(low, high).map(x => x / 2);
        const needed = corners(low, high).map(corner => {
            const from_target = add(corner, this.target, -1);
            const sideways = Math.max(Math.abs(dot(from_target, right)) / aspect, Math.abs(dot(from_target, up)));
            return dot(from_target, backward) + (1.04 * sideways) / tangent;
        });
        this.distance = Math.max(...needed) || 1; // the box of a single point has no size
    }

    orbit(azimuth_deg, elevation_deg) {
        this.azimuth_deg = (((this.azimuth_deg + azimuth_deg) % 360) + 360) % 360;
        this.elevation_deg = Math.min(Math.max(this.elevation_deg + elevation_deg, -90), 90);
    }

    zoom(factor) {
        this.distance *= factor;
    }

    /** Moves the target sideways, by multiples of the picture's height. */
    pan(x, y) {
        const { right, up } = this.axes(),
            height = 2 * this.distance * this.tangent();
        this.target = add(add(this.target, right, -x * height), up, -y * height);
    }

    /** Tangent of half the vertical field of view. */
    tangent() {
        return Math.tan((this.fov_deg * Math.PI) / 360);
    }

    /** Sets a three.js PerspectiveCamera; its near and far planes enclose the box. */
    apply(camera, [low, high], aspect) {
        const { right, up, backward } = this.axes(),
            eye = this.eye();
        const depths = corners(low, high).map(corner => -dot(add(corner, eye, -1), backward));
        camera.fov = this.fov_deg;
        camera.aspect = aspect;
        camera.far = Math.max(...depths, 1e-6) * 1.01;
        camera.near = Math.max(Math.min(...depths) * 0.99, camera.far * 1e-4);
        camera.matrixAutoUpdate = false;
        camera.matrix.set(
            right[0],
            up[0],
            backward[0],
            eye[0],
            right[1],
            up[1],
            backward[1],
            eye[1],
            right[2],
            up[2],
            backward[2],
            eye[2],
            0,
            0,
            0,
            1,
        );
        camera.matrixWorldNeedsUpdate = true;
        camera.updateProjectionMatrix();
    }
}

function corners(low, high) {
    return [0, 1, 2, 3, 4, 5, 6, 7].map(k => [0, 1, 2].map(axis => ((k >> axis) & 1 ? high : low)[axis]));
}
