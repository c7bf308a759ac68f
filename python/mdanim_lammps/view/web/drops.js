// SPDX-License-Identifier: GPL-2.0-only
// Drops of the liquid: round points as wide as the drops are, clear in the middle and bright at the rim.
import { BufferAttribute, BufferGeometry, DynamicDrawUsage, Points, PointsMaterial } from "./vendor.js";

const BALL = `
  vec2 p = 2.0 * gl_PointCoord - 1.0;
  float r = dot(p, p);
  if (r > 1.0) discard;
  float shine = smoothstep(0.25, 0.0, distance(p, vec2(-0.3, -0.4)));
  gl_FragColor = vec4(mix(gl_FragColor.rgb, vec3(1.0), max(0.25 + 0.6 * r * r, shine)), 0.6 + 0.4 * max(r, shine));
  #include <colorspace_fragment>`;

export class Drops {
  constructor(world, { most, color }) {
    [this.at, this.radius] = [new Float32Array(3 * most), new Float32Array(most)];
    this.geometry = new BufferGeometry();
    this.geometry.setAttribute("position", new BufferAttribute(this.at, 3).setUsage(DynamicDrawUsage));
    this.geometry.setAttribute("radius", new BufferAttribute(this.radius, 1).setUsage(DynamicDrawUsage));
    const material = new PointsMaterial({ color, transparent: true });
    material.onBeforeCompile = (shader) => {
      shader.vertexShader = "attribute float radius;\n" + shader.vertexShader.replace("gl_PointSize = size;", "gl_PointSize = radius * size;");
      shader.fragmentShader = shader.fragmentShader.replace("#include <colorspace_fragment>", BALL);
    };
    this.points = new Points(this.geometry, material);
    this.points.frustumCulled = false;
    this.points.renderOrder = 4;
    world.add(this.points);
  }

  // Tell the tangent of half of the camera's vertical angle.
  seenBy(half) {
    this.points.material.size = 2 / half;
  }

  // Rows of middle and radius.
  show(rows) {
    for (let n = 0, k = 0; k < rows.length; n++, k += 4) {
      this.at.set(rows.subarray(k, k + 3), 3 * n);
      this.radius[n] = rows[k + 3];
    }
    this.geometry.setDrawRange(0, rows.length / 4);
    this.geometry.attributes.position.needsUpdate = this.geometry.attributes.radius.needsUpdate = true;
  }
}
