// Reads hard-rays.txt for the programs in this folder, and prints their answers.

import { existsSync, readFileSync } from 'node:fs'
import { resolve } from 'node:path'
import { pathToFileURL } from 'node:url'

function fail (why) {
  console.error(why)
  process.exit(2)
}

// A file of a package that is installed in the working directory.
export async function load (name) {
  const file = resolve('node_modules', name)
  if (!existsSync(file)) fail(`no ${file}: npm install, in the working directory`)
  return import(pathToFileURL(file))
}

// A number in the hexadecimal form of C99: 0x1.8p+1 is 3.
function number (text) {
  const parts = /^(-?)0x([01])(?:\.([0-9a-f]+))?p([+-]\d+)$/.exec(text)
  if (!parts) return NaN
  const [, sign, whole, fraction = '', exponent] = parts
  // Inputs are 32-bit floats: neither the digits nor the power is beyond 64-bit floats.
  const size = parseInt(whole + fraction, 16) * 2 ** (Number(exponent) - 4 * fraction.length)
  return sign ? -size : size
}

// The rays of the file that the command line names. Each number is a 32-bit float.
export function rays () {
  if (process.argv.length !== 3) fail(`usage: ${process.argv[1]} hard-rays.txt`)
  const name = process.argv[2]
  let text
  try {
    text = readFileSync(name, 'utf8')
  } catch (error) {
    fail(error.message)
  }
  if (!text.startsWith('# hard-rays 1,')) fail(`${name}: not hard rays of version 1`)
  const all = []
  for (const [index, line] of text.trimEnd().split('\n').entries()) {
    if (line.startsWith('#')) continue
    const x = line.split(' ').slice(1, 13).map(number)
    if (x.length !== 12 || x.some(Number.isNaN)) fail(`${name}:${index + 1}: not the twelve numbers of a ray`)
    all.push({
      origin: x.slice(0, 3), direction: x.slice(3, 6), tMin: x[6], tMax: x[7], center: x.slice(8, 11), radius: x[11]
    })
  }
  return all
}

// Prints the answers of rays that begin at zero: `ask` gives t or null.
export function answer (rays, ask) {
  const lines = rays.map(ray => {
    if (ray.tMin !== 0) return '-'
    const t = ask(ray)
    return t === null || !(t < ray.tMax) ? 'miss' : String(t)
  })
  console.log(lines.join('\n'))
}
