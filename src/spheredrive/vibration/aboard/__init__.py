"""What people and payloads inside the sphere feel, and the isolator that keeps a payload still."""
