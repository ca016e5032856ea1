"""Networks in ONNX files: the card that says what one takes and gives, what runs it, pictures in and maps out."""
