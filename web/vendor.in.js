// What the pages use of three.js and uPlot; build.sh makes python/mdanim_lammps/view/web/vendor.js of it.
export {
  BackSide, Box3, BufferAttribute, BufferGeometry, Color, DirectionalLight, DynamicDrawUsage, FrontSide, Group,
  HemisphereLight, LineBasicMaterial, LineLoop, LineSegments, Mesh, MeshLambertMaterial, MeshPhongMaterial, PCFShadowMap,
  PerspectiveCamera, PlaneGeometry, Points, PointsMaterial, Raycaster, Scene, Vector2, Vector3, WebGLRenderer,
} from "three";
export { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
export { default as Plot } from "uplot";
