"""Networks in ONNX files: the card that describes one, the runtimes, and the conversion of pictures and maps."""
