/* SPDX-License-Identifier: MIT */
#include "gltf_parallel.h"

#include <atomic>
#include <exception>
#include <thread>
#include <vector>

void gltf_parallel(unsigned threads, size_t count, const std::function<void(size_t i)> &do_one) {
    std::atomic<size_t> next{ 0 };
    auto work = [&] {
        for (size_t i; (i = next++) < count;) do_one(i);
    };
    std::vector<std::thread> others;
    if (threads == 0) threads = std::thread::hardware_concurrency();
    try {
        while (others.size() + 1 < threads && others.size() + 1 < count) others.emplace_back(work);
    } catch (const std::exception &) { /* no thread or no memory for one: this thread does the rest */
    }
    work();
    for (std::thread &other : others) other.join();
}
