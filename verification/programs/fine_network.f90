!> Cracks that see each other, kinked and winged cracks in a window so large that its edge may carry
!! the uniform remote strain (verification/interacting_cracks, kinked_crack, winged_crack).
!!
!! Arguments: element size at the cracks [m], then one of
!!   collinear B             two cracks of length 1 m with a gap of 2 B, s_yy = s_xy = 1 MPa
!!   kink DEGREES B tension  main crack of half-length 1 m with a branch of length B at its right
!!   kink DEGREES B shear    tip; s_yy or s_xy = 1 MPa
!!   wing DEGREES L          closed frictionless crack of half-length 1 m at 45 degrees under
!!                           s_xx = -1 MPa, free wings of length L turned clockwise from its line
!!                           by DEGREES
!! Intensities are in units of 1 MPa sqrt(pi 1 m), of 1 MPa sqrt(pi 0.5 m) for collinear cracks.
program fine_network
   use base_kinds, only: degree => radians, ik, pi, rk
   use fine_faces, only: face_conditions_t, face_slip, loaded_everywhere
   use fine_loads, only: fine_loads_t, no_loads
   use fine_model, only: fine_model_t
   use mesh_types, only: network_t
   use verification_cracks, only: mesh_window, set_remote, write_faces, write_tips
   use verification_files, only: finish, real_argument, text_argument
   use verification_meshes, only: network_of
   implicit none(type, external)

   real(rk), parameter :: megapascal = 1.0e6_rk
   real(rk), parameter :: half_width = 200.0_rk  ! of the window: an error of order (1/200)**2 [m]
   type(network_t) :: network
   type(fine_model_t) :: model
   type(fine_loads_t) :: loads
   type(face_conditions_t) :: conditions
   character(len=:), allocatable :: kind
   real(rk), allocatable :: displacement(:, :), middle(:)
   real(rk) :: h, remote(3), scale, turned(2), first_wing

   h = real_argument(1)
   kind = text_argument(2)
   scale = megapascal*sqrt(pi)
   first_wing = 0.0_rk
   select case (kind)
   case ("collinear")
      associate (b => real_argument(3))
         network = network_of([2_ik, 2_ik], reshape([-1.0_rk - b, 0.0_rk, -b, 0.0_rk, &
                                                     b, 0.0_rk, 1.0_rk + b, 0.0_rk], [2, 4]))
      end associate
      remote = [0.0_rk, megapascal, megapascal]
      scale = scale*sqrt(0.5_rk)
   case ("kink")
      turned = real_argument(4)*[cos(real_argument(3)*degree), sin(real_argument(3)*degree)]
      network = network_of([3_ik], reshape([-1.0_rk, 0.0_rk, 1.0_rk, 0.0_rk, 1.0_rk + turned(1), &
                                            turned(2)], [2, 3]))
      remote = [0.0_rk, megapascal, 0.0_rk]
      if (text_argument(5) == "shear") remote = [0.0_rk, 0.0_rk, megapascal]
   case ("wing")
      first_wing = real_argument(4)
    associate (at => [cos(0.25_rk*pi), sin(0.25_rk*pi)], to => 0.25_rk*pi - real_argument(3)*degree)
         turned = at + first_wing*[cos(to), sin(to)]
         network = network_of([4_ik], reshape([-turned, -at, at, turned], [2, 4]))
      end associate
      remote = [-megapascal, 0.0_rk, 0.0_rk]
   case default
      error stop "unknown kind of network"
   end select

   call mesh_window(network, half_width, h, 0.15_rk*half_width, 12_ik, model)
   loads = no_loads(model%mesh)
   call set_remote(model, remote, loads)
   conditions = loaded_everywhere(model%mesh)
   if (kind == "wing") then
      middle = model%mesh%face_s(3, :)
     where (middle > first_wing .and. middle < first_wing + 2.0_rk) conditions%condition = face_slip
   end if
   call write_tips(model, conditions, loads, scale, displacement)
   call write_faces(model, displacement)
   call finish()

end program fine_network
