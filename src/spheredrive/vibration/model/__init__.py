"""The linear system of a design: equations, poles, natural frequencies and modes."""
