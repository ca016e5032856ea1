"""The guard between force law and motor: force limits, stiffness limit, virtual coupling, passivity."""
