//! OBJ and MTL scenes.
