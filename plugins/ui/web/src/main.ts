import { BufferGeometry, Line, LineBasicMaterial, OrthographicCamera, Scene, Vector3, WebGLRenderer } from "three";

const canvas = document.querySelector<HTMLCanvasElement>("#terrain")!;
const renderer = new WebGLRenderer({ canvas });
const line = new BufferGeometry().setFromPoints([new Vector3(-1, 0, 0), new Vector3(1, 0, 0)]);
const scene = new Scene().add(new Line(line, new LineBasicMaterial({ color: "white" })));
renderer.render(scene, new OrthographicCamera());
