// Answers hard rays with Jolt Physics, jolt-physics 1.1.0 of npm: npm install jolt-physics@1.1.0
//
// node jolt.mjs hard-rays.txt > ANSWERS.txt     in the folder where npm installed it
//
// A SphereShape in a TransformedShape is asked with CastRay, in 32-bit floats. Convex shapes are
// not solid and their back faces are hit, so that rays that start inside hit from there. A ray of
// Jolt ends where its direction does: the direction is multiplied by a power of two that reaches
// beyond the sphere, which rounds nothing. A ray with another t_min than zero is not asked.

import { answer, load, rays } from './hard-rays.mjs'

const asked = rays()
const { default: start } = await load('jolt-physics/dist/jolt-physics.wasm-compat.js')
const Jolt = await start()

const settings = new Jolt.RayCastSettings()
settings.mTreatConvexAsSolid = false
settings.SetBackFaceMode(Jolt.EBackFaceMode_CollideWithBackFaces)
const collector = new Jolt.CastRayClosestHitCollisionCollector()
const filter = new Jolt.ShapeFilter()
const identity = Jolt.Quat.prototype.sIdentity()
const unscaled = new Jolt.Vec3(1, 1, 1)

answer(asked, ({ origin, direction, center, radius }) => {
  const reach = Math.hypot(...origin.map((x, axis) => x - center[axis])) + radius
  const scale = 2 ** Math.ceil(Math.log2(2 * reach / Math.hypot(...direction)))
  const shape = new Jolt.SphereShape(radius)
  shape.AddRef()
  const transformed = new Jolt.TransformedShape()
  const at = new Jolt.RVec3(...center)
  transformed.mShape = shape
  transformed.SetWorldTransform(at, identity, unscaled)
  const from = new Jolt.RVec3(...origin)
  const along = new Jolt.Vec3(...direction.map(x => x * scale))
  const ray = new Jolt.RRayCast(from, along)
  collector.Reset()
  transformed.CastRay(ray, settings, collector, filter)
  const t = collector.HadHit() ? collector.mHit.mFraction * scale : null
  for (const object of [ray, along, from, at, transformed]) Jolt.destroy(object)
  shape.Release()
  return t
})
