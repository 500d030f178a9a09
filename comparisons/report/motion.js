import {WebGLRenderer} from "three";
document.documentElement.dataset.three = typeof WebGLRenderer;
