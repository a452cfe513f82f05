/* SPDX-License-Identifier: MIT
 * See openexr_shim.h. OpenEXR says by exceptions what is wrong; none gets past here.
 */
#include "openexr_shim.h"

#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>

#include <algorithm>
#include <cstring>
#include <new>
#include <stdexcept>
#include <vector>

namespace {

class memory_stream : public Imf::IStream {
  public:
    memory_stream(const uint8_t *bytes, size_t size) : Imf::IStream("picture"), bytes_(bytes), size_(size) {}
    bool read(char to[], int count) override {
        if (count < 0 || size_t(count) > size_ - at_) throw std::runtime_error("cut short");
        std::memcpy(to, bytes_ + at_, size_t(count));
        at_ += size_t(count);
        return at_ < size_;
    }
    uint64_t tellg() override { return at_; }
    void seekg(uint64_t at) override {
        if (at > size_) throw std::runtime_error("cut short");
        at_ = size_t(at);
    }

  private:
    const uint8_t *bytes_;
    size_t size_, at_ = 0;
};

/* Every row in the same place: strides of rows are 0. */
Imf::FrameBuffer one_row(std::vector<float> &values, int left, const char *const channel[3]) {
    Imf::FrameBuffer out;
    for (int k = 0; k < 3; k++) {
        char *base = reinterpret_cast<char *>(values.data() + k) - ptrdiff_t(left) * ptrdiff_t(3 * sizeof(float));
        out.insert(channel[k], Imf::Slice(Imf::FLOAT, base, 3 * sizeof(float), 0));
    }
    return out;
}

void read_rows(const uint8_t *bytes, size_t size, int index, const char *const channel[3], openexr_row_fn row,
               void *user) {
    memory_stream stream(bytes, size);
    Imf::MultiPartInputFile file(stream, 0);
    Imf::InputPart part(file, index);
    const Imath::Box2i window = part.header().dataWindow();
    const size_t width = size_t(window.max.x - window.min.x) + 1;
    std::vector<float> values(3 * width);
    part.setFrameBuffer(one_row(values, window.min.x, channel));
    const bool is_grey = std::strcmp(channel[0], channel[1]) == 0; /* of one name, the last slice counts */
    for (int y = window.min.y; y <= window.max.y; y++) {
        part.readPixels(y);
        for (size_t i = 0; is_grey && i < width; i++) values[3 * i] = values[3 * i + 1] = values[3 * i + 2];
        row(user, y, values.data());
    }
}

} // namespace

openexr_status openexr_read_part(const uint8_t *bytes, size_t size, int part, const char *const channel[3],
                                 openexr_row_fn row, void *user) {
    try {
        read_rows(bytes, size, part, channel, row, user);
        return OPENEXR_READ;
    } catch (const std::bad_alloc &) {
        return OPENEXR_NO_MEMORY;
    } catch (...) {
        return OPENEXR_MALFORMED;
    }
}
