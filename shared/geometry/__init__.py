"""A scene's shapes and walls, their faces and their motion, and the particles that fill them."""
