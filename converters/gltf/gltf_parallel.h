/* SPDX-License-Identifier: MIT
 * How do several threads share what can be written in any order? Private, C++: it knows nothing of the core's jobs.
 */
#ifndef HEMIBAKE_GLTF_PARALLEL_H
#define HEMIBAKE_GLTF_PARALLEL_H

#include <cstddef>
#include <functional>

/* Calls do_one(i) once for each i below count, from any thread; it must not throw. threads: 0 is one for each core.
 * Where fewer can be had, those do it all. */
void gltf_parallel(unsigned threads, size_t count, const std::function<void(size_t i)> &do_one);

#endif
