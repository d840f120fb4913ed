// Answers hard rays with Ray.intersectSphere of three.js r187: npm install three@0.187.0
//
// node three.mjs hard-rays.txt > ANSWERS.txt     in the folder where npm installed it
//
// three.js computes in 64-bit floats and takes directions of length one, so that each is divided by
// its length. intersectSphere answers with the point Ray.at(t); a Ray whose `at` keeps t loses
// nothing to the point's rounding. A ray with another t_min than zero is not asked.

import { answer, load, rays } from './hard-rays.mjs'

const asked = rays()
const { Ray, Sphere, Vector3 } = await load('three/build/three.module.js')

class RayThatKeepsT extends Ray {
  at (t, target) {
    this.t = t
    return super.at(t, target)
  }
}

answer(asked, ({ origin, direction, center, radius }) => {
  const length = Math.hypot(...direction)
  const ray = new RayThatKeepsT(new Vector3(...origin), new Vector3(...direction).divideScalar(length))
  const point = ray.intersectSphere(new Sphere(new Vector3(...center), radius), new Vector3())
  return point && ray.t / length
})
