// SPDX-License-Identifier: Apache-2.0
// What the report uses of three.js; the build makes one classic script of it, the global `Three`.
export {
  BufferAttribute,
  BufferGeometry,
  CircleGeometry,
  Color,
  CylinderGeometry,
  DirectionalLight,
  DoubleSide,
  Group,
  HemisphereLight,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  PerspectiveCamera,
  RingGeometry,
  Scene,
  SphereGeometry,
  Vector3,
  WebGLRenderer,
} from 'three';
export {OrbitControls} from 'three/examples/jsm/controls/OrbitControls.js';
export {LineMaterial} from 'three/examples/jsm/lines/LineMaterial.js';
export {LineSegments2} from 'three/examples/jsm/lines/LineSegments2.js';
export {LineSegmentsGeometry} from 'three/examples/jsm/lines/LineSegmentsGeometry.js';
