#include "ui/wish.hpp"

namespace clarity {

EditedView edited_view(const Wish& wish) {
    EditedView edited;
    edited.view.camera = wish.camera;
    edited.view.background = wish.background;
    edited.view.ambient = wish.ambient;
    edited.view.materials = wish.materials;
    for (const WishedLight& light : wish.lights) {
        edited.view.lights.push_back(light.values);
        edited.lights_on.push_back(light.on);
    }
    edited.hidden = wish.hidden;
    return edited;
}

}  // namespace clarity
