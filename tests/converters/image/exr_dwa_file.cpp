/* SPDX-License-Identifier: MIT
 * What are the bytes of these channels as DWAA or DWAB? As OpenEXR's C++ library writes them, since its core does not.
 */
#include "exr_file.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfOutputFile.h>
#include <ImfTiledOutputFile.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <vector>

namespace {

class memory_stream : public Imf::OStream {
  public:
    memory_stream() : Imf::OStream("picture") {}
    void write(const char from[], int count) override {
        if (bytes.size() < at_ + size_t(count)) bytes.resize(at_ + size_t(count));
        std::memcpy(bytes.data() + at_, from, size_t(count));
        at_ += size_t(count);
    }
    uint64_t tellp() override { return at_; }
    void seekp(uint64_t at) override { at_ = size_t(at); }
    std::vector<char> bytes;

  private:
    size_t at_ = 0;
};

void write_to(memory_stream &out, const exr_file &f) {
    const Imath::Box2i data({ f.data.min.x, f.data.min.y }, { f.data.max.x, f.data.max.y }),
        display({ f.display.min.x, f.display.min.y }, { f.display.max.x, f.display.max.y });
    const int width = data.max.x - data.min.x + 1, height = data.max.y - data.min.y + 1;
    std::vector<std::vector<float>> values;
    Imf::Header header(display, data);
    Imf::FrameBuffer from;
    header.compression() = f.compression == EXR_COMPRESSION_DWAA ? Imf::DWAA_COMPRESSION : Imf::DWAB_COMPRESSION;
    for (int c = 0; c < EXR_FILE_CHANNELS && f.channels[c]; c++) {
        header.channels().insert(f.channels[c], Imf::Channel(Imf::FLOAT));
        values.emplace_back(size_t(width) * size_t(height));
        for (int y = 0; y < height; y++)
            for (int x = 0; x < width; x++)
                values.back()[size_t(y * width + x)] = float(f.value(c, x + data.min.x, y + data.min.y));
        from.insert(f.channels[c], Imf::Slice::Make(Imf::FLOAT, values.back().data(), data));
    }
    if (f.tile > 0) {
        header.setTileDescription(Imf::TileDescription(unsigned(f.tile), unsigned(f.tile)));
        Imf::TiledOutputFile file(out, header, 0);
        file.setFrameBuffer(from);
        file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
    } else {
        Imf::OutputFile file(out, header, 0);
        file.setFrameBuffer(from);
        file.writePixels(height);
    }
}

} // namespace

exr_bytes exr_file_write_dwa(const exr_file *file) {
    memory_stream out;
    try {
        write_to(out, *file);
    } catch (const std::exception &fault) {
        std::fprintf(stderr, "exr_dwa_file: %s\n", fault.what());
        std::abort();
    }
    exr_bytes bytes = { static_cast<uint8_t *>(std::malloc(out.bytes.size() + 1)), out.bytes.size() };
    if (!bytes.bytes) std::abort();
    std::memcpy(bytes.bytes, out.bytes.data(), bytes.size);
    return bytes;
}
