"""Effects around another force law: the option that names it; textures, friction and damping of materials."""
