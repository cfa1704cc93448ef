#include "ui/widgets/fonts.hpp"

// The assembler copies a font file into the program. CLARITY_FONT_*: paths, from ui/CMakeLists.txt.
#define CLARITY_EMBED_FONT(name, path)                                                                            \
    __asm__(".pushsection .rodata\n.balign 16\n.global " #name "\n.hidden " #name "\n" #name ":\n.incbin \"" path \
            "\"\n.global " #name "_end\n.hidden " #name "_end\n" #name "_end:\n.popsection\n");                   \
    extern "C" {                                                                                                  \
    extern const unsigned char name[], name##_end[];                                                              \
    }

CLARITY_EMBED_FONT(clarity_font_text, CLARITY_FONT_TEXT)
CLARITY_EMBED_FONT(clarity_font_bold, CLARITY_FONT_BOLD)
CLARITY_EMBED_FONT(clarity_font_mono, CLARITY_FONT_MONO)

namespace clarity::ui {

ImFont* add_font(ImFontAtlas& atlas, Face face, float pixels) {
    struct Data {
        const unsigned char *begin, *end;
    };
    static const Data faces[] = {{clarity_font_text, clarity_font_text_end},
                                 {clarity_font_bold, clarity_font_bold_end},
                                 {clarity_font_mono, clarity_font_mono_end}};
    // Latin, Greek and Cyrillic (for file names), punctuation, arrows, mathematical and geometric symbols.
    static const ImWchar ranges[] = {0x20,   0x17F,  0x370,  0x3FF,  0x400,  0x52F,  0x2010, 0x2044,
                                     0x2190, 0x21FF, 0x2200, 0x22FF, 0x25A0, 0x25FF, 0};
    const Data& data = faces[static_cast<size_t>(face)];
    ImFontConfig config;
    config.OversampleH = 2;
    config.OversampleV = 1;
    config.FontDataOwnedByAtlas = false;
    return atlas.AddFontFromMemoryTTF(const_cast<unsigned char*>(data.begin), static_cast<int>(data.end - data.begin), pixels,
                                      &config, ranges);
}

}  // namespace clarity::ui
